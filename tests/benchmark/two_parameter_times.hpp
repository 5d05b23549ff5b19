/// Table (c): a step along a fold, period-doubling, torus or grazing curve in two parameters compared with a step along
/// the one-parameter branch of the same orbit on the same mesh.
#pragma once

namespace tchat::benchmark {

/// `rounds` of a way there and back each, in turn; `intervals` = NTST.
void print_two_parameter_times(int rounds, int intervals);

}  // namespace tchat::benchmark

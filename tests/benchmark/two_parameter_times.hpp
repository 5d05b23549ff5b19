/// Table (c): a step along a fold, period-doubling or torus curve in two parameters compared with a step along the
/// one-parameter branch of the same orbit on the same mesh.
#pragma once

namespace tchat::benchmark {

/// `steps`: measured steps of each; `intervals` = NTST.
void print_two_parameter_times(int steps, int intervals);

}  // namespace tchat::benchmark

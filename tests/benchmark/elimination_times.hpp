/// Table (e): the elimination of mesh intervals for several dimensions, in lanes and one block after the other, beside
/// the rate at which the BLAS that is linked multiplies dense matrices.
#pragma once

#include <vector>

namespace tchat::benchmark {

/// Least times of `rounds`, for these n.
void print_elimination_times(const std::vector<int>& dimensions, int rounds);

}  // namespace tchat::benchmark

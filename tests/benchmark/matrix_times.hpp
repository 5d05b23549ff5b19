/// Table (b): the time of one Newton matrix and of the multipliers, in units of the local eliminations it cannot do
/// without.
///
/// The unit is the elimination of NTST random blocks for n = 4, NCOL = 4 (16 rows and one border row, 12 pivots), four
/// at a time in the lanes of vector registers. The kernel works in place, so each block is copied in fresh; the time of
/// copying alone is measured too and taken off. Unit and parts are measured in turn, round by round, and each part is
/// divided by the unit of its own round: what is printed are medians of these ratios.
#pragma once

namespace tchat::benchmark {

/// For m = 1, NTST = 50 intervals.
void print_matrix_times(int rounds);

}  // namespace tchat::benchmark

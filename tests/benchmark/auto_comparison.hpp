/// Table (e): the same k-segment problem, step length, mesh and tolerances in AUTO-07p, IPS = 4.
///
/// Time per step is the difference of two run lengths of AUTO's program, in processor time, so that its start-up drops
/// out; on our side it is that of blocks of steps, taken in turn with AUTO's. Of both the least of all rounds counts.
/// To show that both compute the same branch, our orbit is corrected at the alpha of AUTO's last solution and the
/// states are compared.
#pragma once

#include <vector>

namespace tchat::benchmark {

/// False, after a message that says what to install, when AUTO-07p or gfortran is not there.
bool auto_is_installed();

struct AutoSize {
  int segments;
  int intervals;      ///< NTST
  int dimension = 4;  ///< n; above 4 with one segment
  int wanted = 0;     ///< how many times AUTO's step is to take ours with multipliers; 0: nothing is
};

void print_auto_comparison(const std::vector<AutoSize>& sizes, bool quick);

}  // namespace tchat::benchmark

/// Table (a): how the time of a continuation step grows with the number of segments and of mesh intervals.
#pragma once

#include <vector>

namespace tchat::benchmark {

struct StepSizes {
  std::vector<int> segments;
  std::vector<int> intervals;
  int intervals_for_segments = 50;  ///< NTST while the segments vary
  int rounds = 200;                 ///< measured steps of each size
};

void print_step_times(const StepSizes& sizes);

}  // namespace tchat::benchmark

/// Table (a): how the time of a continuation step grows with the number of segments, also of hundreds, of mesh
/// intervals and of states.
#pragma once

#include <vector>

namespace tchat::benchmark {

struct StepSizes {
  std::vector<int> segments;
  std::vector<int> intervals;
  std::vector<int> dimensions;
  int intervals_for_segments = 50;  ///< NTST while the segments vary
  std::vector<int> many_segments;
  int intervals_for_many = 10;  ///< NTST while many segments vary
  int rounds = 20;              ///< each twice ten steps
};

void print_step_times(const StepSizes& sizes);

}  // namespace tchat::benchmark

/// Table (g): how much memory a run takes, by the number of segments, of mesh intervals and of states.
#pragma once

#include <vector>

namespace tchat::benchmark {

struct MemorySizes {
  std::vector<int> segments;
  std::vector<int> intervals;
  std::vector<int> dimensions;
  int most_intervals = 100;  ///< NTST of the largest problem, whose peak is to stay below 1 GiB
};

/// Peak resident sizes of the real program, which is run for some points.
void print_memory_sizes(const MemorySizes& sizes);

}  // namespace tchat::benchmark

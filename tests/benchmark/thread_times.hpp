/// Table (i): one Newton matrix with its correction by two threads, compared with one thread on the same orbit.
#pragma once

#include <vector>

#include "orbit/orbit.hpp"

namespace tchat::benchmark {

/// Median wall-clock times of `rounds` rounds, in which one thread and two take turns. Throws std::runtime_error where
/// the two corrections are not the same bit by bit.
void print_thread_times(const std::vector<OrbitShape>& shapes, int rounds);

}  // namespace tchat::benchmark

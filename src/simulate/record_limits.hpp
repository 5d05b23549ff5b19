/// Ranges of the numbers in a journal or part of a sweep. Its lines index into arrays and name functions of the
/// problem, and a file may have been edited: nothing of a line is used before it has been checked.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"
#include "simulate/sample_record.hpp"

namespace tchat {

/// `start` of a record that holds a known attractor, whose number, from 1, is its index. An empty record ends them.
inline constexpr int start_of_known = 0;

struct RecordLimits {
  std::size_t values = 0;                 ///< index of a value: 0 to values - 1
  int starts = 0;                         ///< start: 1 to starts
  int known = 0;                          ///< number of a known attractor: 1 to known, 0 for none
  int dimension = 0;                      ///< of states
  int fields = 0, events = 0, jumps = 0;  ///< numbers in index vectors: from 1, in signatures also no_function

  /// Dimension and functions; the other limits are those of a sweep.
  static RecordLimits of(const HybridSystem& system);
};

/// "" or what is out of range: "known is 999; allowed are 0 to 3".
std::string fault_of(const SampleRecord& record, const RecordLimits& limits);

}  // namespace tchat

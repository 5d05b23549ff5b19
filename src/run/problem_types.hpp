/// The problem types there are. A new one is one file in src/bvp with its defining system and one line in the table.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bvp/defining_system.hpp"
#include "constants/run_settings.hpp"

namespace tchat {

struct ProblemType {
  int number;       ///< IPS
  int branch_mode;  ///< ISW
  const char* name;
  int free_parameters;  ///< problem parameters that are free, durations not counted
  std::unique_ptr<DefiningSystem> (*make)(const HybridSystem&, const RunSettings&, std::vector<int> free_parameters);
};

inline int segment_count(const RunSettings& settings) { return static_cast<int>(settings.segments.size()); }

/// Throws UserError with the list of what there is.
const ProblemType& problem_type(const RunSettings& settings);

/// The free problem parameters of the run: the first ones in ICP that are no durations. Throws UserError when ICP names
/// too few.
std::vector<int> free_problem_parameters(const ProblemType& type, const RunSettings& settings);

/// Those and all durations, in the order of ICP, missing durations last: what the run really frees.
std::vector<int> active_parameters(const ProblemType& type, const RunSettings& settings);

}  // namespace tchat

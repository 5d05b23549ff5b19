/// The problem type that constants ask for, and what follows from it for their lists.
#pragma once

#include <optional>
#include <vector>

#include "constants/run_settings.hpp"
#include "problem_type/problem_type.hpp"

namespace tchat {

inline int segment_count(const RunSettings& settings) { return static_cast<int>(settings.segments.size()); }

/// Throws UserError with the list of what there is.
const ProblemType& problem_type(const RunSettings& settings);

/// How many problem parameters the type frees; that of the nearest type where there is none of this IPS and ISW.
int free_parameter_count(int number, int branch_mode);

/// The free problem parameters of the run: the first ones in ICP that are no durations. Throws UserError when ICP names
/// too few.
std::vector<int> free_problem_parameters(const RunSettings& settings);

/// Those and all durations, in the order of ICP, missing durations last: what the run really frees.
std::vector<int> active_parameters(const RunSettings& settings);

/// The segment (from 0) that GCSEGTYP = 2 marks, else the first one.
int marked_segment(const RunSettings& settings);
/// The segment that ends in the contact which the type keeps; nothing for types that keep none.
std::optional<int> contact_segment(const RunSettings& settings);

}  // namespace tchat

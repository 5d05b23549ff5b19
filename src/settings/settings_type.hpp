/// The problem type that constants ask for, and what follows from it for their lists.
#pragma once

#include <optional>
#include <vector>

#include "settings/run_settings.hpp"

namespace tchat {

class ProblemType;
class SolutionFamily;
struct SignatureRules;

inline int segment_count(const RunSettings& settings) { return static_cast<int>(settings.segments.size()); }

/// Is PAR(k) the duration of a segment of the settings?
inline bool is_duration(const RunSettings& settings, int k) {
  return settings.layout.is_duration(k, segment_count(settings));
}
/// Is it a parameter of the problem, or the rotation number?
inline bool is_parameter(const RunSettings& settings, int k) {
  return settings.layout.is_parameter(k, segment_count(settings));
}

/// Throws UserError with the list of what there is.
const ProblemType& problem_type(const RunSettings& settings);

/// The family of the solutions, and its rules for constants.
const SolutionFamily& family_of(const RunSettings& settings);
const SignatureRules& signature_rules(const RunSettings& settings);

/// How many problem parameters a run frees whose segments end in events: those of its type, or of the nearest type
/// where there is none of this IPS and ISW; one more for each monitor that is held, one less where a function is
/// conserved, for its orbits are a family as they are.
int free_parameter_count(const RunSettings& settings);

/// The first entries of ICP that the type frees: where conditions are counted durations too, else problem parameters
/// only. Throws UserError when ICP names too few.
std::vector<int> free_entries(const RunSettings& settings);

/// The problem parameters among them: what the run frees besides durations.
std::vector<int> free_problem_parameters(const RunSettings& settings);
/// One flag for each segment: where events end segments every duration is free.
std::vector<bool> free_durations(const RunSettings& settings);

/// All that the run really frees, in the order of ICP, durations that are free without being in it last.
std::vector<int> active_parameters(const RunSettings& settings);

/// The segment (from 0) that GCSEGTYP = 2 marks, else the first one.
int marked_segment(const RunSettings& settings);
/// The segment that ends in the contact which the type keeps; nothing for types that keep none.
std::optional<int> contact_segment(const RunSettings& settings);

/// The indices that stand for monitors, after the number of segments has changed.
void renumber_monitors(RunSettings& settings, int old_segments);

/// Takes monitors out of UZR, THL, BOUNDS and HOLD, and those that may name a segment out of ICP, as where segments get
/// other numbers. True when there were some.
bool leave_out_monitors(RunSettings& settings);

}  // namespace tchat

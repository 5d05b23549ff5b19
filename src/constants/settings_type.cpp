#include "constants/settings_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hybrid/parameter_vector.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

bool contains(const std::vector<int>& list, int k) { return std::find(list.begin(), list.end(), k) != list.end(); }

}  // namespace

const ProblemType& problem_type(const RunSettings& settings) {
  return problem_type(settings.problem_type, settings.branch_mode);
}

int free_parameter_count(int number, int branch_mode) {
  const ProblemType* type = nearest_problem_type(number, branch_mode);
  return type != nullptr ? type->facts().free_parameters : 1;
}

std::vector<int> free_problem_parameters(const RunSettings& settings) {
  const int needed = problem_type(settings).facts().free_parameters;
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (!is_duration(k, segment_count(settings)) && static_cast<int>(result.size()) < needed) result.push_back(k);
  if (static_cast<int>(result.size()) < needed)
    throw UserError(fmt::format(
        "ICP lists {} problem parameters, IPS = {} with ISW = {} needs {}: durations are free in any case, so name the "
        "parameters to vary, for example ICP = [1, 61]",
        result.size(), settings.problem_type, settings.branch_mode, needed));
  return result;
}

std::vector<int> active_parameters(const RunSettings& settings) {
  const std::vector<int> problem_parameters = free_problem_parameters(settings);
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (is_duration(k, segment_count(settings)) || contains(problem_parameters, k)) result.push_back(k);
  for (int s = 0; s < segment_count(settings); ++s)
    if (!contains(result, first_duration + s)) result.push_back(first_duration + s);
  return result;
}

int marked_segment(const RunSettings& settings) {
  const auto marked = std::find_if(settings.segments.begin(), settings.segments.end(),
                                   [](const SegmentSettings& segment) { return segment.type == 2; });
  return marked == settings.segments.end() ? 0 : static_cast<int>(marked - settings.segments.begin());
}

std::optional<int> contact_segment(const RunSettings& settings) {
  return keeps_contact(settings.problem_type) ? std::optional(marked_segment(settings)) : std::nullopt;
}

}  // namespace tchat

#include "settings/settings_type.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/messages.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

bool contains(const std::vector<int>& list, int k) { return std::find(list.begin(), list.end(), k) != list.end(); }

}  // namespace

const ProblemType& problem_type(const RunSettings& settings) {
  return problem_type(settings.problem_type, settings.branch_mode);
}

const SolutionFamily& family_of(const RunSettings& settings) { return family_of(settings.problem_type); }

const SignatureRules& signature_rules(const RunSettings& settings) { return family_of(settings).facts().signature; }

int ProblemType::free_entries(const RunSettings& settings) const {
  if (!family().facts().signature.counts_conditions) return free_parameter_count(settings);
  return settings.boundary_conditions + settings.integral_conditions - settings.dimension * segment_count(settings) +
         1 + static_cast<int>(settings.held.size());
}

int free_parameter_count(const RunSettings& settings) {
  const ProblemType* type = nearest_problem_type(settings.problem_type, settings.branch_mode);
  const int own = type != nullptr ? type->facts().free_parameters : 1;
  return own + static_cast<int>(settings.held.size()) - (settings.conserved.empty() ? 0 : 1);
}

std::vector<int> free_entries(const RunSettings& settings) {
  const ProblemType& type = problem_type(settings);
  const bool own_conditions = signature_rules(settings).counts_conditions;
  const auto needed = static_cast<std::size_t>(type.free_entries(settings));
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (result.size() < needed && !is_monitor(settings, k) && (own_conditions || !is_duration(settings, k)))
      result.push_back(k);
  if (result.size() == needed) return result;
  if (own_conditions)
    throw UserError(
        fmt::format("ICP lists {} free parameters, the conditions leave {} free (NBC + NINT - n m + 1, with n = {} "
                    "states on m = {} segments): durations are fixed unless they are listed, so name what is to vary",
                    result.size(), needed, settings.dimension, segment_count(settings)));
  throw UserError(
      fmt::format("ICP lists {} problem parameters, IPS = {} with ISW = {}{} needs {}: {}, so name the "
                  "parameters to vary, for example ICP = [{}]",
                  result.size(), settings.problem_type, settings.branch_mode,
                  settings.held.empty() ? "" : fmt::format(" and {} held", settings.held.size()), needed,
                  type.family().facts().signature.durations, type.family().facts().signature.example));
}

std::vector<int> free_problem_parameters(const RunSettings& settings) {
  std::vector<int> result;
  for (const int k : free_entries(settings))
    if (!is_duration(settings, k)) result.push_back(k);
  return result;
}

std::vector<bool> free_durations(const RunSettings& settings) {
  std::vector<bool> free(settings.segments.size(), signature_rules(settings).ends_in_events);
  for (const int k : free_entries(settings))
    if (is_duration(settings, k)) free[static_cast<std::size_t>(settings.layout.duration_segment(k))] = true;
  return free;
}

std::vector<int> active_parameters(const RunSettings& settings) {
  const std::vector<int> entries = free_entries(settings);
  const std::vector<bool> durations = free_durations(settings);
  const auto is_free = [&](int k) {
    return is_duration(settings, k) ? durations[static_cast<std::size_t>(settings.layout.duration_segment(k))]
                                    : contains(entries, k);
  };
  std::vector<int> result;
  for (const int k : settings.free_parameters)
    if (is_free(k)) result.push_back(k);
  for (int s = 0; s < segment_count(settings); ++s)
    if (const int k = settings.layout.duration(s); is_free(k) && !contains(result, k)) result.push_back(k);
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

namespace {

/// change(k) of every index of a parameter, duration or monitor that the settings list; those are left out for which it
/// is true.
template <class Change>
void change_indices(RunSettings& settings, const Change& change) {
  std::erase_if(settings.free_parameters, change);
  std::erase_if(settings.user_values, [&](UserValue& value) { return change(value.parameter); });
  std::erase_if(settings.parameter_weights, [&](IndexedValue& weight) { return change(weight.index); });
  std::erase_if(settings.bounds, [&](BoundedValue& value) { return change(value.parameter); });
  std::erase_if(settings.held, [&](HeldValue& value) { return change(value.parameter); });
}

}  // namespace

void renumber_monitors(RunSettings& settings, int old_segments) {
  const int before = settings.layout.first_monitor(old_segments), now = first_monitor(settings);
  change_indices(settings, [&](int& k) {
    if (k >= before && k < before + static_cast<int>(settings.monitors.size())) k += now - before;
    return false;
  });
}

bool leave_out_monitors(RunSettings& settings) {
  std::vector<std::string> kept;
  std::vector<int> columns;
  for (const int k : settings.free_parameters) {
    const bool is_column = is_monitor(settings, k);
    const std::string name =
        is_column ? settings.monitors[static_cast<std::size_t>(k - first_monitor(settings))] : std::string();
    if (is_column && name.find('(') != std::string::npos) continue;  // of a segment, perhaps
    columns.push_back(is_column ? first_monitor(settings) + static_cast<int>(kept.size()) : k);
    if (is_column) kept.push_back(name);
  }
  const bool some = kept.size() < settings.monitors.size() || !settings.held.empty();
  const auto leaves = [&](int& k) { return is_monitor(settings, k); };
  change_indices(settings, leaves);
  settings.held.clear();
  settings.free_parameters = std::move(columns);
  settings.monitors = std::move(kept);
  return some;
}

}  // namespace tchat

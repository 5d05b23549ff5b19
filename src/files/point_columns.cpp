#include "files/point_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "settings/family.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

constexpr int most_screen_columns = 7;

std::string name_at(const std::vector<std::string>& names, int k, const char* symbol) {
  if (k >= 1 && static_cast<std::size_t>(k) <= names.size()) return names[static_cast<std::size_t>(k) - 1];
  return fmt::format("{}({})", symbol, k);
}

PointColumn parameter_column(int k, const RunSettings& settings, const ProblemNames& names) {
  const int segment = is_duration(settings, k) ? settings.layout.duration_segment(k) + 1 : 0;
  return {PointColumn::Kind::parameter, k, names.parameter(k), segment};
}

}  // namespace

ProblemNames ProblemNames::of(const HybridSystem& system) {
  ProblemNames names;
  for (int k = 1; k <= system.dimension(); ++k) names.states.push_back(system.state_name(k));
  for (int k = 1; k <= system.parameters(); ++k) names.parameters.push_back(system.parameter_name(k));
  const tchat_problem& table = system.table();
  for (int k = 0; k < table.user_values; ++k) {
    const bool named = table.user_value_names != nullptr && table.user_value_names[k] != nullptr;
    names.user_functions.push_back(named ? table.user_value_names[k] : fmt::format("PVLS({})", k + 1));
  }
  for (int k = 1; k <= system.count(FunctionKind::event); ++k)
    names.events.push_back(system.function_name(FunctionKind::event, k));
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    names.jumps.push_back(system.function_name(FunctionKind::jump, k));
  return names;
}

ProblemNames ProblemNames::of(const HybridSystem& system, const RunSettings& settings) {
  ProblemNames names = of(system);
  if (settings.monitors.empty()) return names;
  while (names.parameters.size() + 1 < static_cast<std::size_t>(first_monitor(settings)))
    names.parameters.push_back(fmt::format("PAR({})", names.parameters.size() + 1));
  names.parameters.insert(names.parameters.end(), settings.monitors.begin(), settings.monitors.end());
  return names;
}

void ProblemNames::set_parameter(int k, const std::string& name) {
  while (parameters.size() < static_cast<std::size_t>(k))
    parameters.push_back(fmt::format("PAR({})", parameters.size() + 1));
  parameters[static_cast<std::size_t>(k) - 1] = name;
}

std::string ProblemNames::state(int k) const { return name_at(states, k, "U"); }

std::string ProblemNames::parameter(int k) const { return name_at(parameters, k, "PAR"); }

PointColumn measure_column(int selector, int dimension, const ProblemNames& names) {
  using Kind = PointColumn::Kind;
  if (selector == 0 || selector > 3 * dimension || selector < -dimension) return {Kind::l2_norm, 0, "L2-NORM"};
  const int k = (std::abs(selector) - 1) % dimension + 1;
  const std::string name = names.state(k);
  if (selector < 0) return {Kind::minimum, k, "MIN " + name};
  if (selector <= dimension) return {Kind::maximum, k, "MAX " + name};
  if (selector <= 2 * dimension) return {Kind::integral, k, "INTEGRAL " + name};
  return {Kind::component_l2_norm, k, "L2-NORM " + name};
}

std::vector<PointColumn> point_columns(const RunSettings& settings, const ProblemNames& names) {
  const std::vector<int>& free = settings.free_parameters;
  const auto problem_parameters =
      static_cast<int>(std::count_if(free.begin(), free.end(), [&](int k) { return !is_duration(settings, k); }));
  const int maxima = std::clamp(most_screen_columns - problem_parameters, 0, settings.dimension);

  std::vector<PointColumn> columns;
  if (!free.empty()) columns.push_back(parameter_column(free.front(), settings, names));
  columns.push_back(measure_column(settings.measure, settings.dimension, names));
  const FileHeadings& headings = family_of(settings.problem_type).facts().headings;
  for (int k = 1; k <= maxima; ++k)
    columns.push_back({PointColumn::Kind::maximum, k, headings.maximum + names.state(k)});
  for (std::size_t i = 1; i < free.size(); ++i) columns.push_back(parameter_column(free[i], settings, names));
  const auto is_listed = [&](const std::string& name) {
    return std::any_of(free.begin(), free.end(),
                       [&](int k) { return is_monitor(settings, k) && names.parameter(k) == name; });
  };
  for (std::size_t i = 0; i < names.user_functions.size(); ++i)
    if (!is_listed(names.user_functions[i]))
      columns.push_back({PointColumn::Kind::user_function, static_cast<int>(i) + 1, names.user_functions[i]});
  if (headings.has_period) columns.push_back({PointColumn::Kind::period, 0, "PERIOD"});
  return columns;
}

}  // namespace tchat

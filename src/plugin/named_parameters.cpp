#include "plugin/named_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <vector>

#include "base/near_words.hpp"
#include "base/number.hpp"
#include "base/user_error.hpp"
#include "orbit/monitor.hpp"
#include "orbit/quantity.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

bool is_known(const HybridSystem& system, int k) {
  return k == system.layout().rotation() || is_own_parameter(system, k);
}

bool is_user_function(const HybridSystem& system, const std::string& name) {
  const std::optional<Quantity> quantity = find_quantity(system, name);
  return quantity && quantity->kind == Quantity::Kind::user_function;
}

/// `name` is neither a parameter nor a monitor.
[[noreturn]] void refuse(const HybridSystem& system, const std::string& name, const std::string& where) {
  std::vector<std::string> known{"period"};
  for (int k = 1; k <= system.table().user_values; ++k) known.push_back(user_function_name(system, k));
  const std::string monitors = fmt::format("{}", fmt::join(known, ", "));
  for (int k = 1; k <= system.parameters(); ++k) known.push_back(system.parameter_name(k));
  const std::vector<std::string> near = near_words(name, known);
  throw UserError(fmt::format("{}: {} is no parameter of problem {} (it has {}) and no monitor ({}, max({}), ...){}",
                              where, name, system.name(), parameter_list(system), monitors, state_in_monitor(system, 1),
                              near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, ", "))));
}

}  // namespace

bool has_further_parameters(const HybridSystem& system) {
  return system.table().initial_durations != nullptr || system.table().output_parameters != nullptr;
}

bool is_own_parameter(const HybridSystem& system, int k) {
  return k >= 1 &&
         (k <= system.parameters() || k >= system.layout().first_duration() || has_further_parameters(system));
}

std::string parameter_list(const HybridSystem& system) {
  constexpr int most = 60, first = 20;  // of more, the first and the last
  std::string names;
  for (int i = 1; i <= system.parameters(); ++i)
    if (system.parameters() <= most || i <= first || i == system.parameters())
      names += fmt::format("{}{}", i > 1 ? ", " : "", system.parameter_name(i));
    else if (i == first + 1)
      names += ", ...";
  if (names.empty()) return "none";
  return system.parameters() == 1 ? "PAR(1): " + names
                                  : fmt::format("PAR(1) to PAR({}): {}", system.parameters(), names);
}

int parameter_index(const HybridSystem& system, const std::string& name, const std::string& where) {
  if (const std::optional<int> k = parse_integer(name)) {
    if (is_known(system, *k)) return *k;
  } else if (const int named = system.parameter_index(name); named > 0) {
    return named;
  }
  throw UserError(fmt::format("{}: PAR({}) is no parameter of problem {}; it has {}; PAR({}), ... are the durations",
                              where, name, system.name(), parameter_list(system), system.layout().first_duration()));
}

std::string parameter_name(const HybridSystem& system, const RunSettings& settings, int k) {
  if (is_monitor(settings, k)) return settings.monitors[static_cast<std::size_t>(k - first_monitor(settings))];
  return is_duration(settings, k) ? settings.layout.duration_name(k) : system.parameter_name(k);
}

std::string held_text(const HybridSystem& system, const RunSettings& settings) {
  std::string text;
  for (const HeldValue& held : settings.held)
    text += (text.empty() ? "" : ", ") + parameter_name(system, settings, held.parameter);
  return text;
}

std::vector<MonitorName> monitor_names(const HybridSystem& system, const RunSettings& settings) {
  std::vector<MonitorName> list;
  for (const std::string& name : settings.monitors) list.push_back(parse_monitor(system, name, "constants"));
  return list;
}

void resolve_names(RunSettings& settings, const HybridSystem& system) {
  const ParameterLayout layout = system.layout();
  const auto segments = static_cast<int>(settings.segments.size());
  resolve_names(settings, layout, [&](const std::string& name, const std::string& where) {
    const int own = system.parameter_index(name);
    if (own > 0 && !layout.is_duration(own, segments)) return own;
    if (const std::optional<int> k = layout.duration_of_name(name)) return *k;
    const bool is_monitor = name.find('(') != std::string::npos || name == "period" || is_user_function(system, name);
    if (!is_monitor && !parse_integer(name)) refuse(system, name, where);
    if (!is_monitor) return parameter_index(system, name, where);
    parse_monitor(system, name, where);
    return names_a_monitor;
  });
}

}  // namespace tchat

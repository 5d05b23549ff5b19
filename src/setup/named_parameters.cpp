#include "setup/named_parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <vector>

#include "bvp/monitor.hpp"
#include "bvp/quantity.hpp"
#include "setup/problem_setup.hpp"
#include "text/near_words.hpp"
#include "text/number.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

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

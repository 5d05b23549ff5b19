#include "setup/named_parameters.hpp"

#include <optional>
#include <string>

#include "bvp/monitor.hpp"
#include "setup/problem_setup.hpp"

namespace tchat {

namespace {

bool is_user_function(const HybridSystem& system, const std::string& name) {
  const std::optional<Quantity> quantity = find_quantity(system, name);
  return quantity && quantity->kind == Quantity::Kind::user_function;
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
    if (!is_monitor) return parameter_index(system, name, where);
    parse_monitor(system, name, where);
    return names_a_monitor;
  });
}

}  // namespace tchat

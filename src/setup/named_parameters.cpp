#include "setup/named_parameters.hpp"

#include <optional>
#include <string>

#include "bvp/monitor.hpp"
#include "hybrid/parameter_vector.hpp"
#include "setup/problem_setup.hpp"

namespace tchat {

namespace {

bool is_user_function(const HybridSystem& system, const std::string& name) {
  const std::optional<Quantity> quantity = find_quantity(system, name);
  return quantity && quantity->kind == Quantity::Kind::user_function;
}

}  // namespace

void resolve_names(RunSettings& settings, const HybridSystem& system) {
  resolve_names(settings, [&system](const std::string& name, const std::string& where) {
    if (const int k = system.parameter_index(name); k > 0) return k;
    if (const std::optional<int> k = duration_of_name(name)) return *k;
    const bool is_monitor = name.find('(') != std::string::npos || name == "period" || is_user_function(system, name);
    if (!is_monitor) return parameter_index(system, name, where);
    parse_monitor(system, name, where);
    return names_a_monitor;
  });
}

}  // namespace tchat

#include "setup/named_parameters.hpp"

#include <optional>
#include <string>

#include "bvp/monitor.hpp"
#include "hybrid/parameter_vector.hpp"
#include "setup/problem_setup.hpp"
#include "text/number.hpp"

namespace tchat {

namespace {

/// "T2" is the duration of segment 2.
std::optional<int> duration_index(const std::string& name) {
  if (!name.starts_with('T')) return std::nullopt;
  const std::optional<int> segment = parse_integer(name.substr(1));
  if (!segment || *segment < 1 || *segment > max_segments) return std::nullopt;
  return first_duration - 1 + *segment;
}

}  // namespace

void resolve_names(RunSettings& settings, const HybridSystem& system) {
  resolve_names(settings, [&system](const std::string& name, const std::string& where) {
    if (const int k = system.parameter_index(name); k > 0) return k;
    if (const std::optional<int> k = duration_index(name)) return *k;
    if (name.find('(') == std::string::npos && name != "period") return parameter_index(system, name, where);
    parse_monitor(system, name, where);
    return names_a_monitor;
  });
}

}  // namespace tchat

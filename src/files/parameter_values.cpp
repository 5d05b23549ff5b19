#include "files/parameter_values.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "plugin/named_parameters.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

ParameterVector initial_parameters(const HybridSystem& system) {
  ParameterVector par(system.layout());
  if (system.table().initial_parameters != nullptr)
    for (int i = 0; i < system.parameters(); ++i) par(i) = system.table().initial_parameters[i];
  return par;
}

std::vector<std::pair<int, double>> given_parameters(const DatFile& data, const HybridSystem& system,
                                                     const std::string& path, const ParameterVector& par) {
  std::vector<std::pair<int, double>> given = data.parameters;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const int k = given[i].first; k > par.size())
      throw UserError(fmt::format(
          "{}:{}: PAR({}) is neither a parameter of problem {}, which has {}, nor a duration of its segments, "
          "PAR({}), ...",
          path, data.parameter_lines[i], k, system.name(), system.parameters(), par.layout().first_duration()));
  for (const auto& [name, value] : data.named_parameters)
    given.emplace_back(parameter_index(system, name, path), value);
  return given;
}

std::string parameter_lines(const HybridSystem& system, const Eigen::VectorXd& par) {
  std::string text;
  for (int k = 1; k < system.layout().first_duration(); ++k)
    if (k <= system.parameters() || par(k - 1) != 0.0) text += fmt::format("# PAR({}) = {}\n", k, par(k - 1));
  return text;
}

bool apply_command_line(const HybridSystem& system, const RunSettings& settings, ParameterVector& par) {
  bool changed = false;
  const int segments = segment_count(settings);
  if (par.size() < par.layout().room(segments)) par.make_room(segments);  // a value may be that of a duration
  for (const RunSettings::ParameterValue& value : settings.parameter_values) {
    double& target = par(parameter_index(system, value.name, "command line") - 1);
    changed = changed || target != value.value;
    target = value.value;
  }
  return changed;
}

}  // namespace tchat

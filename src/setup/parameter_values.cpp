#include "setup/parameter_values.hpp"

#include <fmt/format.h>

#include "setup/problem_setup.hpp"

namespace tchat {

ParameterVector initial_parameters(const HybridSystem& system) {
  ParameterVector par = ParameterVector::Zero(parameter_length);
  if (system.table().initial_parameters != nullptr)
    for (int i = 0; i < system.parameters(); ++i) par(i) = system.table().initial_parameters[i];
  return par;
}

std::string parameter_lines(const HybridSystem& system, const Eigen::VectorXd& par) {
  std::string text;
  for (int k = 1; k < first_duration; ++k)
    if (k <= system.parameters() || par(k - 1) != 0.0) text += fmt::format("# PAR({}) = {}\n", k, par(k - 1));
  return text;
}

bool apply_command_line(const HybridSystem& system, const RunSettings& settings, ParameterVector& par) {
  bool changed = false;
  for (const RunSettings::ParameterValue& value : settings.parameter_values) {
    double& target = par(parameter_index(system, value.name, "command line") - 1);
    changed = changed || target != value.value;
    target = value.value;
  }
  return changed;
}

}  // namespace tchat

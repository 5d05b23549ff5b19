#include "kinds/extrema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/user_error.hpp"
#include "orbit/monitor_gradient.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "plugin/named_parameters.hpp"
#include "run/orbit_start.hpp"
#include "run/solver_settings.hpp"
#include "settings/settings_type.hpp"
#include "stability/curve_tests.hpp"

namespace tchat {

namespace {

/// The parameters that ICP names: those that held monitors make depend on the others last.
std::vector<int> gradient_parameters(const HybridSystem& system, const RunSettings& settings) {
  const std::vector<int> free = free_problem_parameters(settings);
  const auto dependent = free.end() - std::ssize(settings.held);
  std::vector<int> list(free.begin(), dependent);
  for (const int k : settings.free_parameters)
    if (k <= system.parameters() && std::find(free.begin(), free.end(), k) == free.end()) list.push_back(k);
  list.insert(list.end(), dependent, free.end());
  return list;
}

std::string nature_text(ReducedGradient::Nature nature) {
  switch (nature) {
    case ReducedGradient::Nature::minimum:
      return "a minimum";
    case ReducedGradient::Nature::maximum:
      return "a maximum";
    case ReducedGradient::Nature::saddle:
      return "a saddle";
    default:
      return "stationary";
  }
}

/// "Gradient of cost: alpha 0, omega 0.312; a minimum in alpha"
std::string gradient_text(const HybridSystem& system, const RunSettings& settings, const Orbit& x) {
  constexpr double near = 1e-5;  // what a located extremum leaves
  const PeriodicOrbitSystem orbits(system, settings.signature(), gradient_parameters(system, settings));
  const std::shared_ptr<const Monitor> objective = principal_monitor(orbits, settings);
  const BranchMonitors monitors = branch_monitors(orbits, settings, x);
  std::string text = "Gradient of " + parameter_name(system, settings, settings.free_parameters.front());
  if (!monitors.held.empty()) text += fmt::format(" with {} held", held_text(system, settings));
  ReducedGradient gradient(orbits, x.shape, *objective, held_monitors(monitors.held));
  if (!gradient.evaluate(x)) return fmt::format("{}: none, for {}", text, gradient.why_none());
  if (gradient.depends_on_phase(x))
    return text + ": none, for it depends on the phase of the orbit, which no event fixes";
  std::vector<int> stationary;
  std::string names;
  for (int k = 0; k < gradient.count(); ++k) {
    const std::string name = system.parameter_name(orbits.free_parameters()[static_cast<std::size_t>(k)]);
    const bool is_zero = gradient.value(k) == 0.0 || gradient.distance(x, k) <= near;
    text += fmt::format("{} {} {:.8g}", k == 0 ? ":" : ",", name, is_zero ? 0.0 : gradient.value(k));
    if (!is_zero) continue;
    stationary.push_back(k);
    names += (names.empty() ? "" : ", ") + name;
  }
  if (stationary.empty()) return text;
  return fmt::format("{}; {} in {}", text, nature_text(gradient.nature(x, stationary)), names);
}

bool is_stationary_start(const HybridSystem& system, const RunSettings& settings, const Orbit& x) {
  const PeriodicOrbitSystem orbits(system, settings.signature(), free_problem_parameters(settings));
  return is_stationary(orbits, x, *principal_monitor(orbits, settings), branch_monitors(orbits, settings, x).held);
}

}  // namespace

bool starts_at_extremum(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  if (!is_monitor(settings, settings.free_parameters.front())) return false;
  return start.kind.kind == UserPointKind::extremum || is_stationary_start(system, settings, start.start.orbit);
}

void check_extremum(const HybridSystem& system, const RunSettings& settings, SelectedStart& start) {
  if (!is_monitor(settings, settings.free_parameters.front()))
    throw UserError(
        fmt::format("{}: ISW = {} follows an extremum of a monitor: name that first in ICP, as in "
                    "ICP = [period, ...], and after it the {} parameters that are free",
                    start.source, settings.branch_mode, settings.branch_mode));
  if (is_stationary_start(system, settings, start.start.orbit)) return;
  const int mode = settings.branch_mode;
  throw UserError(
      fmt::format("{}: {} is not stationary in the first {} of ICP {}, where ISW = {} would begin; name an EX "
                  "label of a run with ISW = {}, and its parameters in the same order",
                  start.source, parameter_name(system, settings, settings.free_parameters.front()),
                  mode == 2 ? "parameter" : fmt::format("{} parameters", mode - 1),
                  start.from_solution ? fmt::format("at label {}", start.label) : "at the start", mode, mode - 1));
}

BranchCurve extrema(const PeriodicOrbitSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const Orbit& x = start.start.orbit;
  auto condition = std::make_unique<StationaryMonitor>(system, x.shape, principal_monitor(system, settings),
                                                       branch_monitors(system, settings, x).held);
  std::string names;
  for (int k = 0; k <= condition->count(); ++k)
    names +=
        (k == 0 ? "" : ", ") + system.system().parameter_name(system.free_parameters()[static_cast<std::size_t>(k)]);
  BranchCurve curve = curve_of(system, std::move(condition), [names](TestList& tests, const StationaryMonitor& kept) {
    tests.push_back(extremum_test(kept, names));
  });
  curve.label_remark = gradient_remark(system.system(), settings);
  return curve;
}

std::function<std::string(const Orbit&)> gradient_remark(const HybridSystem& system, const RunSettings& settings) {
  if (!is_monitor(settings, settings.free_parameters.front()) || !settings.conserved.empty()) return {};
  return [&system, settings](const Orbit& x) { return gradient_text(system, settings, x); };
}

}  // namespace tchat

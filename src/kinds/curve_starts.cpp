#include "kinds/curve_starts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "orbit/bordered_problem.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/monitor_gradient.hpp"
#include "orbit/orbit.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "plugin/problem_setup.hpp"
#include "run/orbit_start.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/curve_tests.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat {

namespace {

/// A branch point that the second parameter breaks has no curve in two parameters.
void refuse_broken(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const std::vector<int> free = free_problem_parameters(settings);
  const PeriodicOrbitSystem plain(system, settings.signature(), free);
  const BranchPointBreaking breaking = branch_point_breaking(plain, start.start.orbit);
  if (!breaking.known || !breaking.by(1)) return;
  const std::string first_name = system.parameter_name(free[0]);
  const std::string second_name = system.parameter_name(free[1]);
  throw UserError(fmt::format(
      "{}: the branch point of label {} is one at this value of {} alone: the branches that cross there part when {} "
      "changes, so there is no curve of branch points in two parameters; with three there is: ISW = 3 and ICP = [{}, "
      "{}, ...] with a third parameter",
      start.source, start.label, second_name, second_name, first_name, second_name));
}

/// Where neither further parameter breaks the branch point, these are surfaces in three.
void refuse_persistent(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const std::vector<int> free = free_problem_parameters(settings);
  const PeriodicOrbitSystem plain(system, settings.signature(), free);
  const Orbit& x = start.start.orbit;
  const BranchPointBreaking breaking = branch_point_breaking(plain, x);
  if (!breaking.known || breaking.by(1) || breaking.by(2)) return;
  throw UserError(
      fmt::format("{}: the branch point of label {} persists when {} or {} changes, as that of a symmetric system "
                  "does: such points "
                  "are surfaces in three parameters, and curves in two; use ISW = 2 with ICP = [{}, {}]",
                  start.source, start.label, system.parameter_name(free[1]), system.parameter_name(free[2]),
                  system.parameter_name(free[0]), system.parameter_name(free[1])));
}

}  // namespace

void start_persistent_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start) {
  refuse_broken(system, settings, start);
}

void start_generic_branch_points(const HybridSystem& system, const RunSettings& settings, SelectedStart& start) {
  refuse_persistent(system, settings, start);
}

namespace {

[[noreturn]] void refuse(const SelectedStart& start, const std::string& why) {
  throw UserError(fmt::format("{}: no curve with ISW = 2 begins at label {} (GR): {}", start.source, start.label, why));
}

}  // namespace

/// Where the second event function vanishes. A segment that lasts no time has the same state at both ends: at its start
/// its own event function is not among the conditions.
std::unique_ptr<OrbitCondition> double_event_condition(const DefiningSystem& defining, const SelectedStart& start) {
  const UserPointKind& kind = start.kind;
  const Orbit& x = start.start.orbit;
  const int s = kind.segment - 1;
  if (kind.kind == UserPointKind::impact_velocity)
    refuse(start, fmt::format("the orbit is tangent to the surface of event {} at the end of segment {}; tchat "
                              "resegment --to grazing-curve makes the start of the curve of such orbits",
                              kind.index, kind.segment));
  if (kind.kind != UserPointKind::contact || s < 0 || s >= defining.segments())
    refuse(start, "the label is no place where two events come at once");
  const bool whole = lasts_no_time(x, s);
  if (!whole && kind.tau > 0.0 && kind.tau < 1.0)
    refuse(start, fmt::format("the contact is inside segment {}, where the orbit touches a surface; tchat resegment "
                              "--to grazing-curve makes the start of the curve of such orbits",
                              kind.segment));
  const bool at_end = !whole && kind.tau == 1.0;
  const bool ended_by = at_end && defining.signature()[static_cast<std::size_t>(s)].event == kind.index;
  if (ended_by || (!at_end && is_pinned_start(defining.system(), defining.signature(), x, s, kind.index)))
    refuse(start, fmt::format("event {} vanishes at the {} of segment {} for every orbit of this signature", kind.index,
                              at_end ? "end" : "start", kind.segment));
  return std::make_unique<EventCondition>(defining, x.shape, s, kind.index, at_end);
}

namespace {

/// A complex number between two real multipliers that have just met, or are about to.
std::complex<double> double_multiplier(const std::vector<std::complex<double>>& multipliers) {
  constexpr double distance = 0.05;
  for (const auto& a : multipliers)
    for (const auto& b : multipliers)
      if (a.imag() == 0.0 && b.imag() == 0.0 && a.real() < b.real() && b.real() - a.real() < distance &&
          std::abs(a.real() * b.real() - 1.0) < distance * distance)
        return {0.5 * (a.real() + b.real()), 0.5 * distance * distance};
  return 0.0;
}

}  // namespace

std::complex<double> pair_at(const DefiningSystem& defining, const SelectedStart& selected) {
  const Orbit& x = selected.start.orbit;
  const PeriodicOrbitSystem plain(defining.system(), defining.signature(), {defining.free_parameters().front()});
  BorderedProblem problem(plain, x.shape, nullptr);
  OrbitResidual residual = problem.make_residual();
  OrbitVector row = problem.condensed().make_vector();
  row.globals(0) = 1.0;
  problem.set_reference(x);
  std::complex<double> nearest = 0.0;
  if (problem.linearize(x, row, residual) == Linearization::ready) {
    const auto multipliers = FloquetSolver(x.shape).compute(problem.condensed(), x).values;
    for (const auto& mu : multipliers)
      if (mu.imag() > 0.0 && std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(nearest) - 1.0)) nearest = mu;
    constexpr double on_circle = 1e-3;
    if (std::abs(std::abs(nearest) - 1.0) > on_circle)
      if (const auto meeting = double_multiplier(multipliers); meeting != 0.0) nearest = meeting;
  }
  if (nearest == 0.0)
    throw NoCurveError(fmt::format("{}: label {} has no complex pair of multipliers, so no torus curve begins there",
                                   selected.source, selected.label));
  return nearest;
}

double fixed_cosine(const DefiningSystem& defining, const SelectedStart& start) {
  const auto is = [&start](PointType type) {
    const int number = basic_type(start.type);
    return number == static_cast<int>(type);
  };
  if (is(PointType::resonance_1) || is(PointType::resonance_2))
    throw UserError(
        fmt::format("{}: at label {}, a 1:1 or 1:2 resonance, the pair of multipliers is a double one and has no angle "
                    "to keep; start from a label TR, R3 or R4, or one of the torus curve (IRS=TR1)",
                    start.source, start.label));
  if (is(PointType::resonance_3)) return -0.5;
  if (is(PointType::resonance_4)) return 0.0;
  return std::cos(std::arg(pair_at(defining, start)));
}

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
  constexpr double near = level::same;  // what a located extremum leaves
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

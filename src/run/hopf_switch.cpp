#include "run/hopf_switch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "orbit/equilibrium_system.hpp"
#include "run/branch_switch.hpp"
#include "run/run_remarks.hpp"
#include "run/solver_settings.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/equilibrium_tests.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;

/// A pair whose sum is a larger share of its size is on neither side of the imaginary axis by the accuracy of a label.
constexpr double on_axis = 1e-3;
/// The share of its scale by which the event function of a section through the equilibrium may miss zero there.
constexpr double on_section = level::same;
/// An oscillation that moves across the section by a smaller share of what it moves lies in it.
constexpr double in_section = level::converged;

/// The eigenvector of i omega.
struct Oscillation {
  double omega;
  Eigen::VectorXcd vector;
};

/// Of a conservative family, which frees no parameter, the equilibrium is found with the first one of the problem.
RunSettings of_equilibrium(RunSettings settings) {
  if (!settings.conserved.empty()) {
    settings.conserved.clear();
    settings.held.clear();
    settings.free_parameters = {1};
  }
  settings.problem_type = equilibrium.number;
  settings.branch_mode = equilibrium.branch_mode;
  settings.segments.front().index.event = no_function;
  settings.segments.front().index.jump = no_function;
  return settings;
}

RunSettings of_periodic_orbit(RunSettings settings) {
  settings.branch_mode = periodic_orbit.branch_mode;
  settings.step = std::abs(settings.step);
  return settings;
}

/// All monitored events have test functions, as on the branch of equilibria. If GCHGRZIND is empty, the events that may
/// come next are monitored.
RunSettings with_watched_events(const HybridSystem& system, RunSettings settings, const Orbit& equilibrium) {
  const std::vector<int>& monitored = settings.segments.front().monitor;
  if (monitored.empty()) watch_possible_events(system, settings, equilibrium);
  if (!settings.test_functions.empty()) return settings;
  settings.test_functions.resize(monitored.size());
  std::iota(settings.test_functions.begin(), settings.test_functions.end(), 1);
  return settings;
}

void check_signature(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  const IndexVector& index = settings.segments.front().index;
  if (settings.segments.size() > 1)
    throw UserError(fmt::format(
        "{}: the orbits that begin at an equilibrium are smooth, and the signature has {} segments; give one, "
        "such as GCFIND = [{}], GCHIND = [0], GCGIND = [0] (no section)",
        selected.source, settings.segments.size(), index.field));
  if (index.jump != no_function && !is_identity_jump(system, index))
    throw UserError(fmt::format(
        "{}: the orbits that begin at an equilibrium are smooth, and jump {} ({}) at the end of the segment is not "
        "the identity; give GCGIND = [0]",
        selected.source, index.jump, system.function_name(FunctionKind::jump, index.jump)));
}

std::string eigenvalue_list(const std::vector<Complex>& values) {
  std::string list;
  for (const Complex& value : values)
    list += fmt::format(
        "{}{:.6g}{}", list.empty() ? "" : ", ", value.real(),
        value.imag() == 0.0 ? "" : fmt::format(" {} {:.6g} i", value.imag() < 0.0 ? "-" : "+", std::abs(value.imag())));
  return list;
}

Oscillation oscillation_of(const DefiningSystem& equilibria, const Orbit& x, double omega) {
  return {omega, eigenvector(equilibrium_jacobian(equilibria, x), {0.0, omega})};
}

Oscillation oscillation_at(const DefiningSystem& equilibria, const Orbit& x, const SelectedStart& selected) {
  const FloquetMultipliers eigenvalues = equilibrium_eigenvalues(equilibria, x);
  const EigenvaluePair pair = hopf_pairs(eigenvalues.values).nearest;
  if (!pair.is_oscillation() || pair.distance > on_axis)
    throw UserError(
        fmt::format("{}: label {} is a Hopf point that is none: no pair of eigenvalues of f_x is on the imaginary axis "
                    "there ({}); a parameter or the problem is another one than that of the label",
                    selected.source, selected.label, eigenvalue_list(eigenvalues.values)));
  return oscillation_of(equilibria, x, std::abs(pair.first.imag()));
}

bool is_label(const SelectedStart& selected, PointType type) {
  return label_type(selected.type) == static_cast<int>(type);
}

/// The equilibrium of the label, corrected; at a zero-Hopf point, where f_x is singular, as it is stored.
Orbit equilibrium_of(const EquilibriumSystem& equilibria, const RunSettings& settings, const SelectedStart& selected) {
  if (is_label(selected, PointType::zero_hopf)) return selected.start.orbit;
  PathFollower along(equilibria, selected.start.orbit.shape, weighted_norm(settings, selected.start.orbit),
                     newton_settings(settings), settings.free_parameters.front());
  return first_point(along, equilibria, selected, settings).point.orbit;
}

/// Turns the phase so that h_x v is a positive multiple of i: h is zero at the ends of the period, and falls there.
void begin_on_section(const HybridSystem& system, int event, const Orbit& x, const SelectedStart& selected,
                      Eigen::VectorXcd& v) {
  const EventAt at = event_at(system, event, x.end(0), x.par.data());
  const std::string name =
      fmt::format("event function {} ({})", event, system.function_name(FunctionKind::event, event));
  constexpr const char* cure = "choose a section through the equilibrium, or none (GCHIND = [0], GCGIND = [0])";
  if (std::abs(at.h) > on_section * at.scale(x.end(0)))
    throw UserError(
        fmt::format("{}: the orbits that are born at label {} do not meet the section: {} is {:.6g} at the "
                    "equilibrium; {}",
                    selected.source, selected.label, name, at.h, cure));
  const Complex across = at.gradient.cast<Complex>().dot(v);
  if (std::abs(across) < in_section * at.gradient.norm() * v.norm())
    throw UserError(fmt::format("{}: the oscillation that is born at label {} lies in the section of {}; {}",
                                selected.source, selected.label, name, cure));
  v *= Complex(0.0, 1.0) * std::abs(across) / across;
}

/// Re(v exp(2 pi i tau)) at the nodes.
void set_oscillation(const Eigen::VectorXcd& v, const Orbit& orbit, OrbitVector& direction) {
  for (int k = 0; k < orbit.shape.nodes_of(0); ++k)
    direction.states.col(k) = (v * std::polar(1.0, 2.0 * std::numbers::pi * orbit.tau(0, k))).real();
}

/// The orbit of the largest amplitude, up to |DS|, that converges.
std::optional<FirstPoint> first_orbit(PathFollower& follower, const Orbit& still, const OrbitVector& direction,
                                      const StepSettings& steps, NewtonStatus& trouble) {
  StepSize step(steps);
  do {
    Orbit orbit = still;
    orbit.states += step.value() * direction.states;
    PathPoint point = follower.make_point(std::move(orbit));
    const NewtonResult result = follower.start_along(point, direction);
    trouble = result.status;
    if (result.converged() && point.orbit.duration(0) > 0.0)
      return FirstPoint{std::move(point), follower.newton().history(), {}, false};
  } while (step.failed());
  return std::nullopt;
}

}  // namespace

/// Where a function is conserved pairs are on the imaginary axis for all values of the parameters (Lyapunov's
/// families), at a double Hopf point two are: MODE chooses one.
double chosen_frequency(const DefiningSystem& equilibria, const Orbit& x, const SelectedStart& selected, int mode) {
  const std::vector<Complex> eigenvalues = equilibrium_eigenvalues(equilibria, x).values;
  double largest = 0.0;
  for (const Complex& value : eigenvalues) largest = std::max(largest, std::abs(value));
  constexpr double zero = level::double_zero;  // of the largest: a double zero is computed to the root of rounding
  std::vector<double> omegas;
  for (const Complex& value : eigenvalues)
    if (value.imag() > zero * largest && std::abs(value.real()) <= on_axis * value.imag())
      omegas.push_back(value.imag());
  std::sort(omegas.begin(), omegas.end());
  if (omegas.empty())
    throw UserError(
        fmt::format("{}: label {} has no oscillation for a family of orbits to start with: no eigenvalue of f_x is on "
                    "the imaginary axis there ({})",
                    selected.source, selected.label, eigenvalue_list(eigenvalues)));
  if (static_cast<std::size_t>(mode) > omegas.size())
    throw UserError(fmt::format("{}: MODE = {}, but label {} has {} oscillation{} (omega = {:.6g}); allowed: {}",
                                selected.source, mode, selected.label, omegas.size(), omegas.size() == 1 ? "" : "s",
                                fmt::join(omegas, ", "),
                                omegas.size() == 1 ? "1" : fmt::format("1 to {}", omegas.size())));
  return omegas[static_cast<std::size_t>(mode - 1)];
}

BranchSetup begin_periodic_orbits(const HybridSystem& system, const RunSettings& settings,
                                  const SelectedStart& selected) {
  if (selected.start.orbit.shape.stored_nodes() > 1)
    throw UserError(fmt::format(
        "{}: label {} (HB) is where a branch of orbits has shrunk to a point, not an equilibrium; start from "
        "the HB label of a run with IPS = {}",
        selected.source, selected.label, equilibrium.number));
  check_signature(system, settings, selected);

  const RunSettings before = of_equilibrium(settings);
  const EquilibriumSystem equilibria(system, before.signature(), free_problem_parameters(before));
  const Orbit x = equilibrium_of(equilibria, before, selected);
  const bool has_several = !settings.conserved.empty() || is_label(selected, PointType::double_hopf);
  Oscillation oscillation =
      has_several ? oscillation_of(equilibria, x, chosen_frequency(equilibria, x, selected, settings.mode))
                  : oscillation_at(equilibria, x, selected);
  const int event = settings.segments.front().index.event;
  if (event != no_function) begin_on_section(system, event, x, selected, oscillation.vector);

  const RunSettings of_orbit = with_watched_events(system, of_periodic_orbit(settings), x);
  const OrbitShape shape = family_of(of_orbit).shape(of_orbit);
  Orbit still{shape, uniform_mesh(shape), x.states.col(0).replicate(1, shape.columns()), x.par};
  still.duration(0) = 2.0 * std::numbers::pi / oscillation.omega;
  SelectedStart start = selected;
  start.start = {still, {}};
  BranchSetup setup = problem_type(of_orbit).prepare(system, of_orbit, start);
  PathPoint from = setup.follower->make_point(still);
  set_oscillation(oscillation.vector, still, from.tangent);
  setup.follower->renormalise(from);

  NewtonStatus trouble = NewtonStatus::converged;
  std::optional<FirstPoint> first =
      first_orbit(*setup.follower, still, from.tangent, continuation_settings(of_orbit).step, trouble);
  if (!first)
    throw ComputationError(
        fmt::format("no periodic orbit beside the equilibrium of label {} of {} for an amplitude "
                    "of {:.3g} or less: {}; try another DS",
                    selected.label, selected.source, std::abs(settings.step), describe(trouble)));
  setup.start = std::move(*first);
  return setup;
}

namespace {

RunSettings with_branch_mode(RunSettings settings, int branch_mode) {
  settings.branch_mode = branch_mode;
  settings.step = std::abs(settings.step);
  settings.curve.clear();
  return settings;
}

/// With the two free parameters exchanged.
RunSettings exchanged(RunSettings settings) {
  const std::vector<int> free = free_problem_parameters(with_branch_mode(settings, orbit_curve.branch_mode));
  for (int& k : settings.free_parameters)
    if (k == free[0])
      k = free[1];
    else if (k == free[1])
      k = free[0];
  return settings;
}

/// An orbit that is born at the label, on the branch in the first parameter.
BranchSetup orbit_beside(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  const RunSettings in_one = with_branch_mode(settings, branch_switch.branch_mode);
  if (selected.start.orbit.shape.stored_nodes() == 1) return begin_periodic_orbits(system, in_one, selected);
  SelectedStart doubling = selected;
  doubling.types = {static_cast<int>(PointType::period_doubling)};
  return switch_branch(system, in_one, doubling);
}

const ProblemType& type_of(PointType curve) {
  const std::vector<const ProblemType*> types = problem_types_of(orbit_curve.number, orbit_curve.branch_mode);
  const auto found = std::find_if(types.begin(), types.end(), [curve](const ProblemType* type) {
    return type->facts().curve == static_cast<int>(curve);
  });
  assert(found != types.end());
  return **found;
}

[[noreturn]] void refuse_without_pair(const SelectedStart& selected) {
  throw NothingBegins(
      fmt::format("no torus curve begins at label {} of {}: the orbits that are born there have no complex pair of "
                  "multipliers on the unit circle",
                  selected.label, selected.source));
}

BranchSetup prepared(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected,
                     const Orbit& beside, PointType curve) {
  SelectedStart start = selected;
  start.start = {beside, {}};
  start.type = static_cast<int>(curve);
  start.types = {start.type};
  try {
    return type_of(curve).prepare(system, settings, start);
  } catch (const NoCurveError&) {
    refuse_without_pair(selected);
  }
}

/// The curve from the orbit `beside` on, of the same amplitude. Throws ComputationError where none is found.
BranchSetup from_orbit(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected,
                       const PathPoint& beside, PointType curve) {
  BranchSetup setup = prepared(system, settings, selected, beside.orbit, curve);
  OrbitVector direction = beside.tangent;
  direction.globals = Eigen::VectorXd::Zero(setup.defining->free_count());
  PathPoint point = setup.follower->make_point(beside.orbit);
  const NewtonResult result = setup.follower->start_along(point, direction);
  const bool is_near = result.converged() && setup.follower->distance(beside.orbit, point.orbit) <= settings.step;
  if (!is_near)
    throw ComputationError(fmt::format(
        "no point of the curve is found beside label {} of {}: {}; try another DS", selected.label, selected.source,
        result.converged() ? "the next one is farther away than DS" : describe(result.status)));
  if (!setup.follower->condition()->beyond_end().empty()) refuse_without_pair(selected);
  setup.start = {std::move(point), setup.follower->newton().history(), {}, false, true};
  return setup;
}

/// One of the parameters may leave the orbits that are born where they are, at the label: then the other one is tried.
/// If both fail, the error is that of the user's own order, unless one of them shows that no curve begins.
BranchSetup begin_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected,
                        PointType curve) {
  std::string trouble;
  bool none_begins = false;
  const auto attempt = [&](bool is_exchanged) -> std::optional<BranchSetup> {
    try {
      const BranchSetup beside = orbit_beside(system, is_exchanged ? exchanged(settings) : settings, selected);
      const RunSettings of_curve = with_branch_mode(beside.settings, orbit_curve.branch_mode);
      return from_orbit(system, is_exchanged ? exchanged(of_curve) : of_curve, selected, beside.start.point, curve);
    } catch (const NothingBegins& error) {
      none_begins = true;
      trouble = error.what();
    } catch (const ComputationError& error) {
      if (trouble.empty()) trouble = error.what();
    }
    return std::nullopt;
  };
  std::optional<BranchSetup> setup = attempt(false);
  if (!setup) setup = attempt(true);
  if (!setup && none_begins) throw NothingBegins(trouble);
  if (!setup) throw ComputationError(trouble);
  return std::move(*setup);
}

}  // namespace

BranchSetup begin_fold_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  return begin_curve(system, settings, selected, PointType::fold);
}

BranchSetup begin_torus_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  return begin_curve(system, settings, selected, PointType::torus);
}

}  // namespace tchat

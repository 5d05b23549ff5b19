#include "run/codimension_two_switch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/user_error.hpp"
#include "run/branch_switch.hpp"
#include "run/hopf_switch.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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
  throw ComputationError(
      fmt::format("{} {} of {}: the orbits that are born there have no complex pair of multipliers on the unit circle",
                  no_curve_begins, selected.label, selected.source));
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
  const auto attempt = [&](bool is_exchanged) -> std::optional<BranchSetup> {
    try {
      const BranchSetup beside = orbit_beside(system, is_exchanged ? exchanged(settings) : settings, selected);
      const RunSettings of_curve = with_branch_mode(beside.settings, orbit_curve.branch_mode);
      return from_orbit(system, is_exchanged ? exchanged(of_curve) : of_curve, selected, beside.start.point, curve);
    } catch (const ComputationError& error) {
      const std::string why = error.what();
      if (trouble.empty() || why.starts_with(no_curve_begins)) trouble = why;
      return std::nullopt;
    }
  };
  std::optional<BranchSetup> setup = attempt(false);
  if (!setup) setup = attempt(true);
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

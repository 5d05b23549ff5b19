#include "run/codimension_two_switch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "constants/settings_type.hpp"
#include "problem_type/point_type.hpp"
#include "problem_type/problem_type.hpp"
#include "run/branch_switch.hpp"
#include "run/hopf_switch.hpp"
#include "text/user_error.hpp"

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
  for (const ProblemType* type : problem_types_of(orbit_curve.number, orbit_curve.branch_mode))
    if (type->facts().curve == static_cast<int>(curve)) return *type;
  return problem_type(orbit_curve.number, orbit_curve.branch_mode);
}

/// The curve from the orbit `beside` on, of the same amplitude. Throws ComputationError where none is found.
BranchSetup from_orbit(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected,
                       const PathPoint& beside, PointType curve) {
  SelectedStart start = selected;
  start.start = {beside.orbit, {}};
  start.type = static_cast<int>(curve);
  start.types = {start.type};
  BranchSetup setup = type_of(curve).prepare(system, settings, start);
  OrbitVector direction = beside.tangent;
  direction.globals = Eigen::VectorXd::Zero(setup.defining->free_count());
  PathPoint point = setup.follower->make_point(beside.orbit);
  const NewtonResult result = setup.follower->start_along(point, direction);
  if (!result.converged())
    throw ComputationError(fmt::format("no point of the curve is found beside label {} of {}: {}; try another DS",
                                       selected.label, selected.source, describe(result.status)));
  if (!setup.follower->condition()->beyond_end().empty())
    throw ComputationError(
        fmt::format("no torus curve begins at label {} of {}: the orbits that are born there have "
                    "no complex pair of multipliers on the unit circle",
                    selected.label, selected.source));
  if (setup.follower->alignment(point, direction) < 0.0) setup.follower->reverse(point);
  setup.start = {std::move(point), setup.follower->newton().history(), {}, true};
  return setup;
}

/// One of the parameters may leave the orbits that are born where they are, at the label: then the other one is tried.
BranchSetup begin_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected,
                        PointType curve) {
  const auto begin = [&](const RunSettings& in_order, bool is_exchanged) {
    const BranchSetup beside = orbit_beside(system, in_order, selected);
    const RunSettings of_curve = with_branch_mode(beside.settings, orbit_curve.branch_mode);
    return from_orbit(system, is_exchanged ? exchanged(of_curve) : of_curve, selected, beside.start.point, curve);
  };
  try {
    return begin(settings, false);
  } catch (const ComputationError&) {
    return begin(exchanged(settings), true);
  }
}

}  // namespace

BranchSetup begin_fold_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  return begin_curve(system, settings, selected, PointType::fold);
}

BranchSetup begin_torus_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected) {
  return begin_curve(system, settings, selected, PointType::torus);
}

}  // namespace tchat

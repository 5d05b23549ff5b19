#include "resegment/impacting_side.hpp"

#include <cmath>

#include "bvp/grazing_orbit_system.hpp"
#include "constants/user_error.hpp"
#include "run/branch_setup.hpp"

namespace tchat {

namespace {

/// d(h_x f) at the end of segment `impact` along the tangent: the second condition of a grazing orbit.
double slope_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                           int impact) {
  const GrazingOrbitSystem grazing(system, defining.signature(), defining.free_parameters(), impact);
  Eigen::Vector2d values;
  Eigen::Matrix2Xd by_state(2, grazing.dimension());
  Eigen::Matrix2Xd by_parameter(2, grazing.free_count());
  grazing.end_derivatives(impact, point.orbit.end(impact), point.orbit.par.data(), values.data(), by_state.data(),
                          by_parameter.data());
  const Eigen::Index end = (impact + 1) * point.orbit.shape.nodes() - 1;
  return by_state.row(1).dot(point.tangent.states.col(end)) + by_parameter.row(1).dot(point.tangent.globals);
}

}  // namespace

int impacting_side(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start, int impact) {
  try {
    const BranchSetup setup = set_up_branch(system, settings, start);
    const double change = slope_along_tangent(system, *setup.defining, setup.start.point, impact);
    if (!std::isfinite(change) || change == 0.0) return 0;
    return change < 0.0 ? 1 : -1;
  } catch (const ComputationError&) {
    return 0;  // the run itself will say why
  }
}

}  // namespace tchat

#include "resegment/branch_side.hpp"

#include <cmath>

#include "base/user_error.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "resegment/orbit_pieces.hpp"
#include "run/branch_setup.hpp"

namespace tchat {

namespace {

/// Of a parameter or a duration: what the correction of a start may change.
constexpr double correction_moves_at_most = 1e-5;
/// A smaller part of the tangent is no change.
constexpr double no_change = 1e-10;

/// d(h_x f) at the end of segment `impact` along the tangent: the second condition of a grazing orbit.
double slope_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                           int impact) {
  const GrazingOrbitSystem grazing(system, defining.signature(), defining.free_parameters(), impact);
  Eigen::Vector2d values;
  Eigen::Matrix2Xd by_state(2, grazing.dimension());
  Eigen::Matrix2Xd by_parameter(2, grazing.free_count());
  grazing.end_derivatives(impact, point.orbit.end(impact), point.orbit.par.data(), values.data(), by_state.data(),
                          by_parameter.data());
  const Eigen::Index end = point.orbit.shape.last_node(impact);
  return by_state.row(1).dot(point.tangent.states.col(end)) + by_parameter.row(1).dot(point.tangent.globals);
}

/// dh at the end of a segment along the tangent.
double event_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                           const Birth::EndEvent& at) {
  Eigen::VectorXd by_state(defining.dimension());
  Eigen::VectorXd by_parameter(defining.free_count());
  double h = 0.0;
  system.first(FunctionKind::event, at.event, point.orbit.end(at.segment), point.orbit.par.data(),
               defining.free_parameters(), &h, by_state.data(), by_parameter.data());
  const Eigen::Index end = point.orbit.shape.last_node(at.segment);
  return by_state.dot(point.tangent.states.col(end)) + by_parameter.dot(point.tangent.globals);
}

/// dh along the tangent at a place where the surface is touched: as h_x f = 0 there, that of the least value of h.
double least_along_tangent(const HybridSystem& system, const DefiningSystem& defining, const PathPoint& point,
                           const Birth::InnerContact& at) {
  const Orbit& x = point.orbit;
  const CollocationRule rule(x.shape.collocation);
  Orbit tangent = x;
  tangent.states = point.tangent.states;
  const Eigen::VectorXd state = state_at(x, rule, at.segment, at.tau);
  Eigen::VectorXd by_state(defining.dimension());
  Eigen::VectorXd by_parameter(defining.free_count());
  double h = 0.0;
  system.first(FunctionKind::event, at.event, state.data(), x.par.data(), defining.free_parameters(), &h,
               by_state.data(), by_parameter.data());
  return by_state.dot(state_at(tangent, rule, at.segment, at.tau)) + by_parameter.dot(point.tangent.globals);
}

/// Of parameters and durations. The monitors behind them in PAR are evaluated by the run, not stored in its start.
bool has_moved(const Orbit& found, const Orbit& start) {
  const Eigen::Index own = start.par.layout().first_monitor(start.shape.segments) - 1;
  const auto before = start.par.head(own).array();
  const double scale = 1.0 + std::abs(start.period());
  return ((found.par.head(own).array() - before).abs() > correction_moves_at_most * (scale + before.abs())).any();
}

int sign_of(double rate) { return std::abs(rate) > no_change ? (rate > 0.0 ? 1 : -1) : 0; }

}  // namespace

int side_of_birth(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                  const Birth& birth) {
  try {
    const BranchSetup setup = set_up_branch(system, settings, start);
    const PathPoint& point = setup.start.point;
    if (has_moved(point.orbit, start.start.orbit)) return 0;
    std::vector<int> sides;
    for (const int s : birth.impacts) sides.push_back(-sign_of(slope_along_tangent(system, *setup.defining, point, s)));
    for (const int s : birth.empty_segments) sides.push_back(sign_of(point.tangent.durations(s)));
    for (const Birth::EndEvent& late : birth.late_events)
      sides.push_back(sign_of(event_along_tangent(system, *setup.defining, point, late)));
    for (const Birth::InnerContact& lost : birth.lost_contacts)
      sides.push_back(sign_of(least_along_tangent(system, *setup.defining, point, lost)));
    for (const int side : sides)
      if (side != sides.front()) return 0;
    return sides.empty() ? 0 : sides.front();
  } catch (const ComputationError&) {
    return 0;  // the run itself will say why
  }
}

}  // namespace tchat

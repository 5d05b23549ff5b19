#include "maps/simulated_torus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/user_error.hpp"
#include "motion/segment_flow.hpp"
#include "orbit/torus_system.hpp"

namespace tchat {

namespace {

std::string text_of(const IndexVector& index) {
  return fmt::format("({}, {}, {})", index.field, index.event, index.jump);
}

/// How many segments from `first` on are those of the signature, again and again.
std::size_t agreeing(const std::vector<PassedSegment>& motion, const Signature& one_return, std::size_t first) {
  std::size_t k = first;
  while (k < motion.size() && motion[k].index == one_return[(k - first) % one_return.size()]) ++k;
  return k - first;
}

/// In turns. The middle of the widest gap that points leave on the circle, and its width.
std::pair<double, double> widest_gap_of(const Eigen::RowVectorXd& turns) {
  std::vector<double> sorted;
  for (const double t : turns) sorted.push_back(t - std::floor(t));
  std::sort(sorted.begin(), sorted.end());
  double middle = 0.0, width = -1.0;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const double next = k + 1 < sorted.size() ? sorted[k + 1] : sorted.front() + 1.0;
    if (next - sorted[k] <= width) continue;
    width = next - sorted[k];
    middle = 0.5 * (next + sorted[k]);
  }
  return {middle, width};
}

[[noreturn]] void fail(int orbit, std::size_t segment, const std::string& why) {
  throw ComputationError(
      fmt::format("return {} from the fitted curve cannot be integrated, segment {}: {}", orbit + 1, segment + 1, why));
}

}  // namespace

Eigen::MatrixXd points_of_returns(const std::vector<PassedSegment>& motion, const Signature& one_return,
                                  const std::string& source) {
  const std::size_t m = one_return.size();
  std::size_t best = 0;
  for (std::size_t first = 1; first < std::min(m, motion.size()); ++first)
    if (agreeing(motion, one_return, first) > agreeing(motion, one_return, best)) best = first;
  const std::size_t count = agreeing(motion, one_return, best);
  if (best + count < motion.size())
    throw UserError(
        fmt::format("{}: the motion does not go by the signature of one return: segment {} after the transient is {}, "
                    "not {}; give the "
                    "signature that the motion on the torus has (O.events of a plain simulation lists it), drop a "
                    "longer transient, or "
                    "follow the signature's own events alone (--follow-signature)",
                    source, best + count + 1, text_of(motion[best + count].index), text_of(one_return[count % m])));
  Eigen::MatrixXd points(motion.front().start.size(), static_cast<Eigen::Index>((count + m - 1) / m));
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = motion[best + static_cast<std::size_t>(k) * m].start;
  return points;
}

PointsWithAngles with_angles(const HybridSystem& system, const Signature& one_return, Eigen::MatrixXd points,
                             const ParameterVector& par) {
  constexpr Eigen::Index samples = 20;
  constexpr double empty = 0.05;  // turns: so many points of a curve that goes round leave less
  constexpr double turn = 2.0 * std::numbers::pi;
  PointsWithAngles result;
  for (const Eigen::Index state :
       angle_states(system, one_return, points.leftCols(std::min(samples, points.cols())), par)) {
    const auto [middle, width] = widest_gap_of(points.row(state) / turn);
    if (width < empty) result.winding.push_back(state);
    // From the middle of the gap on: a curve that does not go round is in one piece then.
    for (double& x : points.row(state)) x -= turn * std::floor(x / turn - middle + 1.0);
  }
  result.points = std::move(points);
  return result;
}

Orbit orbits_from_curve(const HybridSystem& system, const Signature& one_return, const InvariantCurve& curve,
                        const ParameterVector& par, int orbits, int intervals, int collocation) {
  const auto m = static_cast<int>(one_return.size());
  const OrbitShape shape{system.dimension(), orbits * m, intervals, collocation};
  Orbit x{shape, uniform_mesh(intervals), Eigen::MatrixXd(shape.dimension, shape.columns()), par};
  x.par.rotation() = curve.rotation();
  FlowOptions options;
  options.relative_tolerance = 1e-12;
  options.absolute_tolerance = 1e-13;
  options.surface_tolerance = 1e-5;  // the fitted curve is on the section to the accuracy of the fit
  options.variational = false;
  for (int i = 0; i < orbits; ++i) {
    Eigen::VectorXd state = curve.at(static_cast<double>(i) / orbits);
    for (int s = 0; s < m; ++s) {
      const IndexVector& index = one_return[static_cast<std::size_t>(s)];
      const SegmentFlow whole = integrate_segment(system, index, state, par, options);
      if (whole.status != FlowStatus::event_reached) fail(i, static_cast<std::size_t>(s), whole.message);
      const int segment = i * m + s;
      x.duration(segment) = whole.duration;
      for (int k = 0; k < shape.nodes(); ++k) {
        x.states.col(segment * shape.nodes() + k) = state;
        if (k + 1 == shape.nodes()) break;
        const SegmentFlow part =
            integrate_for(system, index.field, state, par, (x.tau(k + 1) - x.tau(k)) * whole.duration, options);
        if (part.status == FlowStatus::failed) fail(i, static_cast<std::size_t>(s), part.message);
        state = part.end_state;
      }
      Eigen::VectorXd next(shape.dimension);
      system.value(FunctionKind::jump, index.jump, state.data(), par.data(), next.data());
      state = next;
    }
  }
  return x;
}

}  // namespace tchat

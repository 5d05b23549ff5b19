#include "maps/torus_label.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/user_error.hpp"
#include "maps/circle.hpp"
#include "model/event_at.hpp"
#include "motion/segment_flow.hpp"
#include "orbit/torus_system.hpp"
#include "run/orbit_start.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Orbit orbit_of_label(const HybridSystem& system, const LabelledSolution& solution, const RunSettings& settings,
                     const std::string& source) {
  const auto n = static_cast<Index>(system.dimension());
  const Index m = segment_count(settings);
  const Index rows = solution.states.rows();
  if (rows % (n * m) != 0 || rows / (n * m) % 2 == 0 || rows / (n * m) < 3)
    throw UserError(
        fmt::format("{}: {} states at each time are no odd number of returns of {} segments of {} states; give the "
                    "constants of its run with -c",
                    source, rows, m, n));
  return orbit_from_solution(
             in_layout(solution, system.layout()),
             {system.dimension(), static_cast<int>(rows / n), solution.mesh_intervals, solution.collocation_points}, {},
             source)
      .orbit;
}

InvariantCurve curve_through(const MatrixXd& values, double rotation, const VectorXd& winding) {
  MatrixXd periodic = values;
  for (Index l = 0; l < values.cols(); ++l)
    periodic.col(l) -= static_cast<double>(l) / static_cast<double>(values.cols()) * winding;
  return {phase_fraction(rotation), winding, TrigonometricSeries::through(periodic)};
}

}  // namespace

TorusLabel::TorusLabel(const HybridSystem& system, const LabelledSolution& solution, const RunSettings& settings,
                       std::string source)
    : system_(system),
      settings_(settings),
      source_(std::move(source)),
      orbit_(orbit_of_label(system, solution, settings, source_)),
      torus_(system, settings.signature(), orbit_.shape.segments / segment_count(settings), {},
             torus_winding(system, settings.signature(), orbit_)) {
  const int m = torus_.segments_per_return();
  const TorusWinding& winding = torus_.winding();
  for (int s = 0; s < m; ++s) {
    const IndexVector& index = settings_.segments[static_cast<std::size_t>(s)].index;
    if (std::any_of(sections_.begin(), sections_.end(), [&](const Section& of) { return of.event == index.event; }))
      continue;
    MatrixXd values(system_.dimension(), orbits());
    for (int i = 0; i < orbits(); ++i) values.col(i) = Eigen::Map<const VectorXd>(orbit_.end(i * m + s), values.rows());
    // Angles that do not go round, as a map that counts them modulo 2 pi has them.
    for (Index a = 0; a < values.rows(); ++a)
      if (winding.curve(a) == 0.0 && winding.returns(a) != 0.0)
        values.row(a).array() -= full_turn * std::floor(values.row(a).mean() / full_turn);
    sections_.push_back(
        {index.event, index.field, index.jump, curve_through(values, rotation(), winding.curve), values});
  }
}

/// From the mesh point before it, by the flow, the time corrected by Newton's method.
VectorXd TorusLabel::on_p(int wall, int field, const VectorXd& from, double duration) const {
  FlowOptions options;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-14;
  options.variational = false;
  VectorXd x = from;
  constexpr int most_corrections = 6;
  for (int k = 0; k < most_corrections; ++k) {
    const SegmentFlow flow = integrate_for(system_, field, from, orbit_.par, duration, options);
    if (flow.status == FlowStatus::failed)
      throw ComputationError(fmt::format("{}: a point of P cannot be found: {}", source_, flow.message));
    x = flow.end_state;
    const EventAt at = event_at(system_, wall, field, x.data(), orbit_.par.data());
    const double step = -at.rate() / rate_gradient(system_, at, wall, field, x.data(), orbit_.par.data()).dot(at.f);
    duration += step;
    if (std::abs(step) <= 1e-13 * (1.0 + std::abs(duration))) break;
  }
  return x;
}

/// Those of one return, from its beginning on.
std::vector<VectorXd> TorusLabel::wall_contacts(int wall, int field, double phi) const {
  const Orbit x = return_at(torus_, orbit_, phase_fraction(phi));
  const int c = x.shape.collocation;
  std::vector<VectorXd> points;
  for (int s = 0; s < x.shape.segments; ++s) {
    if (settings_.segments[static_cast<std::size_t>(s)].index.field != field) continue;
    double before = 0.0;
    for (int k = 0; k < x.shape.nodes(); ++k) {
      const double rate = event_at(system_, wall, field, x.node(s, k), x.par.data()).rate();
      if (before < 0.0 && rate >= 0.0) {
        const int left = (k - 1) / c * c;
        const double share = before / (before - rate);
        const double tau = x.tau(k - 1) + share * (x.tau(k) - x.tau(k - 1));
        points.push_back(on_p(wall, field, Eigen::Map<const VectorXd>(x.node(s, left), x.shape.dimension),
                              (tau - x.tau(left)) * x.duration(s)));
      }
      before = rate;
    }
  }
  return points;
}

MatrixXd TorusLabel::points_on_p(int wall, int field, int count) const {
  MatrixXd points(system_.dimension(), count);
  Index known = 0;
  constexpr int returns_in_vain = 1000;
  for (int k = 0; known < count; ++k) {
    if (k >= returns_in_vain && known == 0)
      throw UserError(
          fmt::format("{}: nowhere on the torus is event {} ({}) least along a trajectory; name another wall with "
                      "--wall",
                      source_, wall, system_.function_name(FunctionKind::event, wall)));
    for (const VectorXd& x : wall_contacts(wall, field, k * rotation()))
      if (known < count) points.col(known++) = x;
  }
  return points;
}

}  // namespace tchat

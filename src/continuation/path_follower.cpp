#include "continuation/path_follower.hpp"

#include <algorithm>
#include <cmath>

#include "bvp/mesh_adaptation.hpp"

namespace tchat {

namespace {

/// Factors older than this (relative change of the point since) are renewed before anything is read off them.
constexpr double current_enough = 1e-10;

}  // namespace

PathFollower::PathFollower(const DefiningSystem& system, const OrbitShape& shape, WeightedNorm norm,
                           const NewtonSettings& settings, int principal, std::unique_ptr<OrbitCondition> condition,
                           BranchMonitors monitors)
    : system_(system),
      norm_(std::move(norm)),
      principal_(principal),
      monitors_(std::move(monitors.watched)),
      problem_(system, shape, std::move(condition), std::move(monitors.held), settings.threads),
      newton_(problem_, settings),
      settings_(settings),
      row_(condensed().make_vector()) {
  problem_.remember(unused_);
}

PathPoint PathFollower::make_point(Orbit orbit) const {
  return {std::move(orbit), condensed().make_vector(), condensed().make_vector(), unused_};
}

OrbitVector PathFollower::principal_row(const Orbit& x) const {
  OrbitVector row = condensed().make_vector();
  if (monitors_.has_gradient(principal_)) {
    monitors_.gradient(principal_, x, condensed().rule(), row);
  } else if (is_duration(principal_, system_.segments())) {
    row.durations(duration_segment(principal_)) = 1.0;
  } else {
    row.globals(principal_global()) = 1.0;
  }
  return row;
}

double PathFollower::principal_direction(const PathPoint& point) const {
  if (monitors_.has_gradient(principal_)) return dot(principal_row(point.orbit), point.tangent);
  if (is_duration(principal_, system_.segments())) return point.tangent.durations(duration_segment(principal_));
  return point.tangent.globals(principal_global());
}

Eigen::Index PathFollower::principal_global() const {
  const auto& free = system_.free_parameters();
  return std::find(free.begin(), free.end(), principal_) - free.begin();
}

double PathFollower::alignment(const PathPoint& point, const OrbitVector& direction) const {
  OrbitVector v = direction;
  OrbitVector dual = condensed().make_vector();
  normalise(point.orbit, v, dual);
  return dot(dual, point.tangent);
}

double PathFollower::distance(const Orbit& a, const Orbit& b) const {
  OrbitVector difference = condensed().make_vector();
  OrbitVector dual = condensed().make_vector();
  difference.states = a.states - b.states;
  for (int s = 0; s < a.shape.segments; ++s) difference.durations(s) = a.duration(s) - b.duration(s);
  const std::vector<int>& free = system_.free_parameters();
  for (std::size_t g = 0; g < free.size(); ++g)
    difference.globals(static_cast<Eigen::Index>(g)) = a.par(free[g] - 1) - b.par(free[g] - 1);
  norm_.dual(a, condensed().rule(), free, difference, dual);
  return std::sqrt(std::abs(dot(dual, difference)));
}

bool PathFollower::linearize_at(const PathPoint& point) {
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  return linearize(point.orbit, point.dual);
}

bool PathFollower::linearize(const Orbit& x, const OrbitVector& row) {
  if (&row != &row_) row_ = row;
  return problem_.linearize(x, row_, newton_.residual()) == Linearization::ready;
}

void PathFollower::normalise(const Orbit& x, OrbitVector& tangent, OrbitVector& dual) const {
  norm_.dual(x, condensed().rule(), system_.free_parameters(), tangent, dual);
  const double length = std::sqrt(std::abs(dot(dual, tangent)));
  if (!(length > 0.0)) return;
  tangent.scale(1.0 / length);
  dual.scale(1.0 / length);
}

/// From the current factors: the vector that every condition but the border annihilates.
bool PathFollower::find_tangent(const Orbit& x, OrbitVector& tangent, OrbitVector& dual) {
  problem_.solve(1.0, tangent);
  if (!tangent.states.allFinite() || !tangent.durations.allFinite() || !tangent.globals.allFinite()) return false;
  normalise(x, tangent, dual);
  return true;
}

/// Newton on the border in rows_, then the tangent at the result.
NewtonResult PathFollower::correct_and_orient(PathPoint& point, const Orbit& base, double target) {
  NewtonResult result = newton_.correct(point.orbit, row_, base, target);
  if (!result.converged()) return result;
  const bool current = result.change_since_factorization <= current_enough;
  if ((!current && !linearize(point.orbit, row_)) || !find_tangent(point.orbit, point.tangent, point.dual))
    result.status = NewtonStatus::singular;
  problem_.remember(point.memory);
  monitors_.store(point.orbit, condensed().rule());
  return result;
}

NewtonResult PathFollower::step(const PathPoint& from, double ds, PathPoint& to) {
  to.orbit.mesh = from.orbit.mesh;
  to.orbit.states = from.orbit.states;
  to.orbit.par = from.orbit.par;
  advance(to.orbit, ds, from.tangent, system_.free_parameters());
  return step_near(from, ds, to);
}

NewtonResult PathFollower::step_near(const PathPoint& from, double ds, PathPoint& to) {
  row_.states = from.dual.states;
  row_.durations = from.dual.durations;
  row_.globals = from.dual.globals;
  problem_.recall(from.memory);
  problem_.set_reference(from.orbit);
  return correct_and_orient(to, from.orbit, ds);
}

bool PathFollower::solves(const Orbit& x) {
  problem_.set_reference(x);
  problem_.evaluate(x, newton_.residual());
  return is_rounding(problem_.residual_size(newton_.residual()), x);
}

/// The first component of the tangent that is not negligible decides: the principal parameter's when it varies.
void PathFollower::orient(PathPoint& point) const {
  constexpr double negligible = 1e-8;
  double direction = principal_direction(point);
  for (Eigen::Index g = 0; std::abs(direction) < negligible && g < point.tangent.globals.size(); ++g)
    direction = point.tangent.globals(g);
  for (Eigen::Index s = 0; std::abs(direction) < negligible && s < point.tangent.durations.size(); ++s)
    direction = point.tangent.durations(s);
  if (direction < 0.0) reverse(point);
}

NewtonResult PathFollower::start_at_fixed_parameter(PathPoint& point) {
  row_ = principal_row(point.orbit);
  problem_.recall(point.memory);
  const Orbit base = point.orbit;
  problem_.set_reference(base);
  NewtonResult result = correct_and_orient(point, base, 0.0);
  if (result.converged()) orient(point);
  return result;
}

NewtonResult PathFollower::start_along(PathPoint& point, const OrbitVector& direction) {
  point.tangent = direction;
  normalise(point.orbit, point.tangent, point.dual);
  row_ = point.dual;
  problem_.recall(point.memory);
  const Orbit base = point.orbit;
  problem_.set_reference(base);
  return correct_and_orient(point, base, 0.0);
}

NewtonResult PathFollower::start_by_minimum_norm(PathPoint& point) {
  // Any border that is not orthogonal to the null vector will do to find it the first time.
  row_.states.setZero();
  for (Eigen::Index i = 0; i < row_.states.size(); ++i)
    row_.states.data()[i] = std::cos(1.0 + 0.37 * static_cast<double>(i));
  row_.durations.setOnes();
  row_.globals.setOnes();
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  NewtonResult result;
  result.status = NewtonStatus::singular;
  if (!linearize(point.orbit, row_) || !find_tangent(point.orbit, point.tangent, point.dual)) return result;
  // A few Gauss-Newton steps with a fresh null vector each, then the ordinary iteration across the last one.
  for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
    row_ = point.dual;
    const Orbit base = point.orbit;
    problem_.set_reference(base);
    result = correct_and_orient(point, base, 0.0);
    if (result.converged() || result.status == NewtonStatus::not_finite) break;
    if (!linearize(point.orbit, row_) || !find_tangent(point.orbit, point.tangent, point.dual)) return result;
  }
  if (result.converged()) orient(point);
  return result;
}

void PathFollower::change_mesh(PathPoint& point, const std::vector<double>& mesh) const {
  const OrbitShape& shape = point.orbit.shape;
  point.orbit.states = interpolate_states(point.orbit.states, shape, point.orbit.mesh, shape, mesh);
  point.tangent.states = interpolate_states(point.tangent.states, shape, point.orbit.mesh, shape, mesh);
  point.orbit.mesh = mesh;
  normalise(point.orbit, point.tangent, point.dual);
}

void PathFollower::reverse(PathPoint& point) const {
  point.tangent.scale(-1.0);
  point.dual.scale(-1.0);
}

CondensedSystem::Singularity PathFollower::singularity(const PathPoint& point) {
  row_ = point.dual;
  problem_.recall(point.memory);
  problem_.set_reference(point.orbit);
  if (problem_.linearize(point.orbit, row_, newton_.residual()) == Linearization::not_finite) return {1.0, {}};
  return condensed().singularity();
}

}  // namespace tchat

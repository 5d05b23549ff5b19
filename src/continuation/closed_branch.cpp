#include "continuation/closed_branch.hpp"

#include <algorithm>
#include <cmath>

#include "continuation/path_follower.hpp"
#include "continuation/solution_measure.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

namespace {

/// A branch has left its first point when it has gone so many times its distance from it.
constexpr double left_behind = 2.0;
/// Shares of the step by which the first point may lie outside of it: interpolation between meshes moves it that much.
constexpr double margin = 1e-3;
/// How far beside the step the first point may lie, as a share of the step, for a trial to be worth while.
constexpr double beside = 2.0;
/// Cosine of the angle between the branch's two directions at its first point: the same but for what bends between
/// points that differ by Newton's tolerance.
constexpr double one_direction = 0.99;
/// So many of Newton's tolerances are no difference.
constexpr double same = 10.0;
/// Measures of one orbit with different phases differ by the error of their quadrature.
constexpr double same_measures = 1e-6;
/// A step along the tangent, to see how measures change.
constexpr double probe = 1e-4;

/// Is `ratio` on [0, 1] but for the margin?
bool is_on_step(double ratio) { return ratio >= -margin && ratio <= 1.0 + margin; }

}  // namespace

void ClosedBranch::begin(const PathPoint& first, double direction) {
  first_ = first;
  moved_ = first.orbit;
  travelled_ = 0.0;
  if (phase_is_fixed_) return;
  measure_sizes_ = Eigen::VectorXd();
  measure_sizes_ = 1.0 + measures(first.orbit).array().abs();
  first_measures_ = measures(first.orbit);
  Orbit beyond = first.orbit;
  advance(beyond, std::copysign(probe, direction), first.tangent, system_.free_parameters());
  first_direction_ = measures(beyond) - first_measures_;
}

std::optional<ClosedBranch::Return> ClosedBranch::on_step(const PathPoint& here, const PathPoint& next, double ds) {
  const std::optional<double> length = phase_is_fixed_ ? place(here, ds) : place_of_measures(here, next, ds);
  if (!length) return std::nullopt;
  Return way{here, *length};
  follower_.change_mesh(way.from, first_.orbit.shape, first_.orbit.mesh);
  if (reach(way, next, ds)) return way;
  follower_.linearize_at(next);
  return std::nullopt;
}

/// Where the plane across the tangent through the first point cuts a step; nothing where it does not, or far away.
std::optional<double> ClosedBranch::place(const PathPoint& here, double ds) {
  if (here.orbit.mesh != moved_.mesh) {
    const Orbit& first = first_.orbit;
    const CollocationRule& rule = follower_.condensed().rule();
    transfer_.set(first.shape, first.mesh, here.orbit.shape, here.orbit.mesh, rule);
    transfer_(first.states, moved_.states);
    moved_.shape = here.orbit.shape;
    moved_.mesh = here.orbit.mesh;
  }
  const double length = dot_difference(here.dual, moved_, here.orbit, system_.free_parameters());
  if (!is_on_step(length / ds)) return std::nullopt;
  const double distance = follower_.distance(here.orbit, moved_);
  if (!(travelled_ > left_behind * distance) || distance > beside * std::abs(ds)) return std::nullopt;
  return length;
}

/// The same by the measures, on the line from those at the start of the step to those at its end.
std::optional<double> ClosedBranch::place_of_measures(const PathPoint& here, const PathPoint& next, double ds) const {
  const Eigen::VectorXd start = measures(here.orbit);
  const Eigen::VectorXd across = measures(next.orbit) - start;
  const Eigen::VectorXd to_first = first_measures_ - start;
  const double share = to_first.dot(across) / across.squaredNorm();
  const bool ahead = to_first.dot(first_direction_) > same_measures * first_direction_.norm();
  if (!ahead || !is_on_step(share) || across.dot(first_direction_) <= 0.0 || to_first.norm() > beside * across.norm())
    return std::nullopt;
  return share * ds;
}

/// Steps from `way.from` to the first point: true, and the length of the step, when that is where it leads.
bool ClosedBranch::reach(Return& way, const PathPoint& next, double ds) {
  constexpr int most_trials = 8;
  constexpr double settled = 1e-10;  // share of the step
  PathPoint trial = way.from;
  if (phase_is_fixed_) {
    way.length = dot_difference(way.from.dual, first_.orbit, way.from.orbit, system_.free_parameters());
    return follower_.step(way.from, way.length, trial).converged() && is_first(trial);
  }
  const Eigen::VectorXd across = measures(next.orbit) - measures(way.from.orbit);
  for (int k = 0; k < most_trials; ++k) {
    if (!follower_.step(way.from, way.length, trial).converged()) return false;
    const double rest = (first_measures_ - measures(trial.orbit)).dot(across) / across.squaredNorm();
    if (std::abs(rest) <= settled) break;
    way.length += rest * ds;
  }
  return is_first(trial);
}

/// On the mesh of the first point.
bool ClosedBranch::is_first(const PathPoint& point) const {
  const NewtonSettings& newton = follower_.newton_settings();
  const Orbit& a = first_.orbit;
  const Orbit& b = point.orbit;
  const auto equal = [&](double one, double other) {
    return std::abs(one - other) <= same * newton.tolerance_parameters * (1.0 + std::abs(one));
  };
  for (const int k : system_.free_parameters())
    if (!equal(a.par(k - 1), b.par(k - 1))) return false;
  for (int s = 0; s < a.shape.segments; ++s)
    if (!equal(a.duration(s), b.duration(s))) return false;
  if (!phase_is_fixed_) return (measures(b) - first_measures_).cwiseAbs().maxCoeff() <= same_measures;
  const double size = 1.0 + a.states.cwiseAbs().maxCoeff();
  return (a.states - b.states).cwiseAbs().maxCoeff() <= same * newton.tolerance_states * size &&
         dot(first_.dual, point.tangent) > one_direction;
}

/// Free parameters, durations, means and root mean squares of the states, each relative to 1 + its size at the first
/// point.
Eigen::VectorXd ClosedBranch::measures(const Orbit& x) const {
  const int n = x.shape.dimension;
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(n);
  std::vector<double> list;
  for (const int k : system_.free_parameters()) list.push_back(x.par(k - 1));
  for (int s = 0; s < x.shape.segments; ++s) list.push_back(x.duration(s));
  for (int k = n + 1; k <= 3 * n; ++k) list.push_back(solution_measure(x, follower_.condensed().rule(), weights, k));
  Eigen::VectorXd result = Eigen::VectorXd::Map(list.data(), static_cast<Eigen::Index>(list.size()));
  if (measure_sizes_.size() > 0) result = result.cwiseQuotient(measure_sizes_);
  return result;
}

}  // namespace tchat

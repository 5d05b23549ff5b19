#include "run/crossing_branches.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/levels.hpp"

namespace tchat {

namespace {

/// Relative changes along v: of the free parameters, the durations and the states at the start of the orbit.
std::vector<double> changes_along(const DefiningSystem& system, const Orbit& x, const OrbitVector& v) {
  std::vector<double> changes;
  for (int g = 0; g < system.free_count(); ++g) changes.push_back(v.globals(g) / parameter_size(system, x, g));
  for (int s = 0; s < x.shape.segments; ++s)
    changes.push_back(v.durations(s) / (time_size(system, x) + std::abs(x.duration(s))));
  const double size = 1.0 + x.states.cwiseAbs().maxCoeff();
  for (int a = 0; a < x.shape.dimension; ++a) changes.push_back(v.states(a, 0) / size);
  double largest = 0.0;
  for (const double c : changes) largest = std::max(largest, std::abs(c));
  if (largest > 0.0)
    for (double& c : changes) c /= largest;
  return changes;
}

void add(OrbitVector& v, double factor, const OrbitVector& other) {
  v.states += factor * other.states;
  v.durations += factor * other.durations;
  v.globals += factor * other.globals;
}

/// Unit vectors of k entries, spread evenly, of two opposite ones both.
std::vector<Eigen::VectorXd> spread_directions(std::size_t k) {
  std::vector<Eigen::VectorXd> result;
  if (k == 2) {
    constexpr int on_circle = 24;
    for (int j = 0; j < on_circle; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / on_circle;
      result.emplace_back(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return result;
  }
  constexpr std::size_t pairs_per_vector = 16;
  std::mt19937_64 numbers(1);  // the same in every run
  std::normal_distribution<double> normal;
  for (std::size_t j = 0; j < pairs_per_vector * k; ++j) {
    Eigen::VectorXd v(static_cast<Eigen::Index>(k));
    for (double& entry : v) entry = normal(numbers);
    result.emplace_back(v.normalized());
    result.emplace_back(-result.back());
  }
  return result;
}

PathPoint along(PathFollower& follower, const std::vector<PathPoint>& null, const Eigen::VectorXd& shares) {
  PathPoint result = null.front();
  result.tangent.set_zero();
  for (std::size_t i = 0; i < null.size(); ++i)
    add(result.tangent, shares(static_cast<Eigen::Index>(i)), null[i].tangent);
  follower.renormalise(result);
  return result;
}

/// Do the changes along one direction come before those along another? The first that differs visibly decides.
bool precedes(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double visible = 0.05;  // of the largest: the length of a step changes less
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > visible) return a[i] > b[i];
  return false;
}

}  // namespace

void orient(const DefiningSystem& system, const Orbit& x, OrbitVector& v) {
  const std::vector<double> changes = changes_along(system, x, v);
  const auto first =
      std::find_if(changes.begin(), changes.end(), [](double c) { return std::abs(c) > level::visible; });
  if (first != changes.end() && *first < 0.0) v.scale(-1.0);
}

double take_off(const PathPoint& point, OrbitVector& v) {
  const double before = dot(v, v), share = dot(point.dual, v);
  add(v, -share, point.tangent);
  return std::sqrt(dot(v, v) / before);
}

OrbitResidual any_right_hand_side(const CondensedSystem& condensed, int which) {
  OrbitResidual residual = condensed.make_residual();
  const double further = 0.37 * which;  // of other frequencies, for sums of sines of one are of two dimensions
  for (std::size_t i = 0; i < residual.collocation.size(); ++i)
    residual.collocation[i] = std::sin(1.0 + (0.83 + further) * static_cast<double>(i));
  std::size_t row = 0;
  double phase = 0.4;
  for (int s = 0; s < condensed.shape().segments; ++s) {  // the last n rows of each group
    const int rows = condensed.system().coupling_rows(s);
    const int filled = std::min(rows, condensed.shape().dimension);
    row += static_cast<std::size_t>(rows - filled);
    for (int a = 0; a < filled; ++a, phase += 1.7 + further) residual.coupling[row++] = std::cos(phase);
  }
  return residual;
}

namespace {

/// Those of Newton's matrix. What it makes of a right-hand side is long where it is a null vector, of order one else.
std::vector<OrbitVector> null_vectors(PathFollower& follower, const PathPoint& point) {
  CondensedSystem& condensed = follower.condensed();
  std::vector<OrbitVector> vectors;
  if (!follower.linearize_at(point)) return vectors;
  const std::vector<double> border(static_cast<std::size_t>(condensed.border_rows()), 0.0);
  for (int k = 0; k <= point.orbit.shape.dimension; ++k) {
    vectors.push_back(condensed.make_vector());
    condensed.solve(any_right_hand_side(condensed, k), border, vectors.back());
  }
  if (!condensed.closing_rows_gave_way()) return vectors;
  // Another row has taken the place of the tangent: what is across that is as long as the first.
  OrbitVector v = condensed.make_vector();
  condensed.null_vector(v);
  v.scale(std::sqrt(dot(vectors.front(), vectors.front()) / dot(v, v)));
  vectors.insert(vectors.begin() + 1, std::move(v));
  return vectors;
}

}  // namespace

std::vector<PathPoint> null_directions(PathFollower& follower, const PathPoint& point) {
  constexpr double shortest = 1e-2;  // a symmetry's multipliers are equal; others are at different distances from +1
  std::vector<OrbitVector> vectors = follower.condensed().system().crossing_directions(point.orbit, point.tangent);
  const bool are_known = !vectors.empty();
  if (!are_known) vectors = null_vectors(follower, point);
  std::vector<PathPoint> result;
  double longest = 0.0, rest = 0.0;
  for (OrbitVector& v : vectors) {
    take_off(point, v);
    for (const PathPoint& other : result) add(v, -dot(other.dual, v), other.tangent);
    PathPoint direction = point;
    direction.tangent = v;
    follower.renormalise(direction);
    const double length = std::abs(dot(direction.dual, v));
    longest = std::max(longest, length);
    if (length > shortest * longest)
      result.push_back(std::move(direction));
    else
      rest = std::max(rest, length);
  }
  // A regular matrix makes vectors of like lengths of everything.
  const bool is_singular = are_known || (result.size() < vectors.size() && rest <= level::visible * longest);
  if (!is_singular && result.size() > 1) result.erase(result.begin() + 1, result.end());
  return result;
}

namespace {

using Line = Eigen::VectorXd;

bool is_same_line(const Line& a, const Line& b, double cosine) { return std::abs(a.dot(b)) > cosine; }

/// The direction in which a step along `line` ends, in terms of the v.
std::optional<Line> line_reached(PathFollower& follower, const std::vector<PathPoint>& null, const Line& line,
                                 double length, const LeaveAlong& leave) {
  const std::optional<Orbit> reached = leave(along(follower, null, line), length);
  if (!reached) return std::nullopt;
  const std::vector<int>& free = follower.condensed().system().free_parameters();
  Line result(line.size());
  for (std::size_t i = 0; i < null.size(); ++i)
    result(static_cast<Eigen::Index>(i)) = dot_difference(null[i].dual, *reached, null[i].orbit, free);
  if (!(result.norm() > 0.0)) return std::nullopt;
  return result.normalized();
}

/// A line that a step along it leads back to, from one that a step has led to.
std::optional<Line> confirmed(PathFollower& follower, const std::vector<PathPoint>& null, Line line, double length,
                              const LeaveAlong& leave) {
  constexpr int rounds = 4;
  constexpr double back = 0.9998;  // cosine: to about a degree
  for (int round = 0; round < rounds; ++round) {
    std::optional<Line> next = line_reached(follower, null, line, length, leave);
    if (!next) return std::nullopt;
    if (is_same_line(line, *next, back)) return next;
    line = std::move(*next);
  }
  return std::nullopt;
}

}  // namespace

std::vector<OrbitVector> crossing_tangents(PathFollower& follower, const std::vector<PathPoint>& null,
                                           const LeaveAlong& leave) {
  constexpr double lengths[] = {1.0, 10.0};  // terms of third order may be too small at one, others at the other
  constexpr std::size_t most_lines = 60;
  constexpr double apart = 0.9;  // cosine: of eight lines in a plane it is 0.92, and symmetries have fewer
  const DefiningSystem& system = follower.condensed().system();
  const Orbit& x = null.front().orbit;
  std::vector<Line> lines;
  const auto is_known = [&lines](const Line& line) {
    return std::any_of(lines.begin(), lines.end(), [&](const Line& other) { return is_same_line(line, other, apart); });
  };
  const auto follow = [&](const Line& from) {
    for (const double length : lengths) {
      const std::optional<Line> reached = line_reached(follower, null, from, length, leave);
      if (!reached || is_known(*reached)) continue;
      std::optional<Line> line = confirmed(follower, null, *reached, length, leave);
      if (line && !is_known(*line)) lines.push_back(std::move(*line));
    }
  };
  for (const Line& direction : spread_directions(null.size())) follow(direction);
  // Half way between two branches the symmetry that exchanges them has a line of its own, which steps may shun.
  for (std::size_t i = 1; i < lines.size() && lines.size() < most_lines; ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const double sign : {1.0, -1.0}) {
        const Line between = (lines[i] + sign * lines[j]).normalized();
        if (!is_known(between)) follow(between);
      }
  std::vector<OrbitVector> tangents;
  for (const Line& line : lines) {
    tangents.push_back(along(follower, null, line).tangent);
    orient(system, x, tangents.back());
  }
  std::stable_sort(tangents.begin(), tangents.end(), [&](const OrbitVector& a, const OrbitVector& b) {
    return precedes(changes_along(system, x, a), changes_along(system, x, b));
  });
  return tangents;
}

}  // namespace tchat

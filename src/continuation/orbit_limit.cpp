#include "continuation/orbit_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/levels.hpp"
#include "base/limit_at_zero.hpp"
#include "model/events.hpp"
#include "stability/curve_tests.hpp"

namespace tchat {

namespace {

/// The tangent knows sizes to their square.
bool has_size(const Approach& reached, double wanted) { return std::abs(reached.size - wanted) <= 0.5 * wanted; }

/// A limit of a free parameter.
struct Limit {
  double value, uncertainty;
};

/// Those of the free parameters at size zero, from orbits of sizes `largest` down to `smallest`, each half the one
/// before, since rounding grows as sizes fall. Empty where there are too few.
std::vector<Limit> limits_of_parameters(PathFollower& follower, const DefiningSystem& system, const PathPoint& from,
                                        const Shrinking& what, double largest, double smallest) {
  constexpr int fewest = 3;
  constexpr double safety = 5.0;  // of the agreement of two orders
  std::vector<LimitAtZero> found(system.free_parameters().size());
  int count = 0;
  PathPoint here = from;
  const int halvings = static_cast<int>(std::lround(std::log2(largest / smallest)));
  for (int k = 0; k <= halvings; ++k) {
    const double size = std::ldexp(largest, -k);
    const Approach reached = approach(follower, here, what, size);
    if (!has_size(reached, size)) continue;
    here = reached.point;
    for (std::size_t i = 0; i < found.size(); ++i)
      found[i].add(what.argument(here.orbit), here.orbit.par(system.free_parameters()[i] - 1), 0.0);
    ++count;
  }
  std::vector<Limit> limits;
  for (const LimitAtZero& limit : found)
    if (count >= fewest) limits.push_back({limit.best, safety * limit.error});
  return limits;
}

/// Of contact behind the limit of impacts, segment s: the rate of the event function at its release as a share of the
/// function's range in contact over the duration; nothing for other segments.
std::optional<double> share_of_release(const DefiningSystem& system, const Orbit& x, int s) {
  const Signature& signature = system.signature();
  const IndexVector& before = signature[static_cast<std::size_t>((s + system.segments() - 1) % system.segments())];
  const IndexVector& own = signature[static_cast<std::size_t>(s)];
  const HybridSystem& functions = system.system();
  const tchat_chatter* const mode = functions.chatter_with_limit(before.jump);
  if (mode == nullptr || own.field != mode->contact || own.event != mode->release) return std::nullopt;
  double most = 0.0;
  for (int k = 0; k < x.shape.nodes_of(s); ++k)
    most = std::max(most, functions.event(own.event, x.states.col(x.shape.first_node(s) + k).data(), x.par.data()));
  const double* end = x.states.col(x.shape.first_node(s) + x.shape.nodes_of(s) - 1).data();
  return std::abs(event_at(functions, own.event, own.field, end, x.par.data()).rate()) * x.duration(s) / most;
}

/// The mean of each node's state and of that half a doubled orbit away.
Eigen::MatrixXd same_in_halves(const Orbit& x, const CollocationRule& rule) {
  const int m = x.shape.segments, half = m / 2;
  Eigen::MatrixXd result(x.states.rows(), x.states.cols());
  for (int s = 0; s < m; ++s)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const double tau = x.tau(s, k), there = half > 0 ? tau : std::fmod(tau + 0.5, 1.0);
      const int column = x.shape.first_node(s) + k;
      result.col(column) = 0.5 * (x.states.col(column) + state_at(x, rule, (s + half) % m, there));
    }
  return result;
}

Eigen::VectorXd same_in_halves(const Eigen::VectorXd& durations) {
  Eigen::VectorXd result = durations;
  const Eigen::Index m = durations.size(), half = m / 2;
  for (Eigen::Index s = 0; s < m; ++s) result(s) = 0.5 * (durations(s) + durations((s + half) % m));
  return result;
}

}  // namespace

Approach approach(PathFollower& follower, const PathPoint& from, const Shrinking& what, double wanted) {
  constexpr int max_steps = 60;
  constexpr double smallest_change = 0.98, largest_change = 1e-3;
  Approach here{from, 0.0, what.size(from.orbit), {}};
  PathPoint trial = from;
  double change = largest_change;
  for (int k = 0; k < max_steps && change < smallest_change && !has_size(here, wanted); ++k) {
    const double target = std::clamp(wanted, change * here.size, here.size / change);
    const double ds = (target / here.size - 1.0) / what.growth(here.point);
    if (!std::isfinite(ds)) break;
    const NewtonResult newton = follower.step(here.point, ds, trial);
    const Approach there{trial, here.length + ds, what.size(trial.orbit), newton};
    const bool is_there = newton.converged() && has_size(there, target) && what.is_same(here.point.orbit, trial.orbit);
    if (is_there) here = there;
    change = is_there ? largest_change : std::sqrt(change);
  }
  return here;
}

Shrinking shrinking_amplitude(const OrbitTrend& trend, int orbits) {
  constexpr double alike = 0.8;  // cosine
  return {[&trend](const Orbit& x) { return trend.amplitude(x); },
          [orbits](const PathPoint& at) { return deviation_growth(at.orbit, at.tangent.states, orbits); },
          [orbits](const Orbit& x, const Orbit& y) { return deviation_cosine(x, y, orbits) >= alike; },
          [](const Orbit& x) { return std::pow(deviation_norm(x), 2); }};
}

bool is_curve_of_folds(PathFollower& follower) {
  const OrbitCondition* condition = follower.condition();
  return condition != nullptr && condition->count() == 1 && condition->kept_multiplier() == 1;
}

void put_end_of_doubled_folds(PathFollower& follower, const DefiningSystem& system, const PathPoint& from, double ds,
                              Orbit& x) {
  // There d^4 and what rounding / d^2 makes of parameters are about the same.
  constexpr double best = 0.006, least_share = 0.3;
  const CollocationRule& rule = follower.condensed().rule();
  const double d = differences_of_halves(from.orbit, system.segments(), rule).norm() /
                   (1.0 + from.orbit.states.cwiseAbs().maxCoeff());
  PathPoint near = from;
  if (!follower.step(from, std::max(least_share, 1.0 - best / d) * ds, near).converged()) return;
  Orbit change = near.orbit;
  change.states = near.tangent.states;
  const Eigen::VectorXd rate = differences_of_halves(change, system.segments(), rule);
  const double rest = -differences_of_halves(near.orbit, system.segments(), rule).dot(rate) / rate.squaredNorm();
  if (!std::isfinite(rest)) return;
  const Eigen::VectorXd durations = same_in_halves(near.orbit.par.durations(system.segments()));
  const Eigen::VectorXd of_durations = same_in_halves(near.tangent.durations);
  x = near.orbit;
  x.states = same_in_halves(near.orbit, rule) + 0.5 * rest * same_in_halves(change, rule);
  for (int s = 0; s < system.segments(); ++s) x.duration(s) = durations(s) + 0.5 * rest * of_durations(s);
  for (std::size_t g = 0; g < system.free_parameters().size(); ++g)
    x.par(system.free_parameters()[g] - 1) += 0.5 * rest * near.tangent.globals(static_cast<Eigen::Index>(g));
}

std::optional<SmallestOrbit> smallest_orbit(PathFollower& follower, const DefiningSystem& system, const PathPoint& from,
                                            const OrbitTrend& trend) {
  const bool are_folds = is_curve_of_folds(follower);
  const bool is_branch = follower.condition() == nullptr && system.free_count() == 1 && follower.held().empty();
  const bool are_tori = system.orbits() > 1;
  if (!are_tori && (!is_smooth(system) || !(is_branch || are_folds))) return std::nullopt;
  constexpr double of_folds = 5e-4, of_branch = level::same;
  const double small_enough = are_folds ? 2e-2 : 2e-3;
  const Shrinking amplitude = shrinking_amplitude(trend, system.orbits());
  Approach smallest = approach(follower, from, amplitude, are_folds ? of_folds : of_branch);
  if (smallest.size > small_enough) return std::nullopt;
  SmallestOrbit result{std::move(smallest.point), {}};
  if (!are_folds) return result;
  constexpr double largest_share = 0.32, smallest_share = 0.008;
  const std::vector<Limit> limits =
      limits_of_parameters(follower, system, from, amplitude, largest_share, smallest_share);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    result.point.orbit.par(system.free_parameters()[i] - 1) = limits[i].value;
    result.uncertainties.push_back(limits[i].uncertainty);
  }
  return result;
}

std::string tangent_release(PathFollower& follower, const DefiningSystem& system, const PathPoint& from) {
  constexpr double small = 0.05, largest_of_limit = 32.0, proportional = 0.1;
  const int m = system.segments();
  int contact = -1;
  for (int s = 0; s < m && m > 1; ++s)
    if (const auto share = share_of_release(system, from.orbit, s); share && *share < small) contact = s;
  if (contact < 0) return "";
  const int flight = (contact + 1) % m;
  const auto duration = [flight](const Orbit& x) { return x.duration(flight); };
  const Shrinking what{
      duration, [flight](const PathPoint& at) { return at.tangent.durations(flight) / at.orbit.duration(flight); },
      [&](const Orbit&, const Orbit& y) { return duration(y) > 0.0; }, duration};
  const double now = duration(from.orbit);
  // A release that is almost tangential all along has flights of other durations.
  const Approach longer = approach(follower, from, what, 2.0 * now);
  const std::optional<double> share = share_of_release(system, from.orbit, contact),
                              of_longer = share_of_release(system, longer.point.orbit, contact);
  if (!has_size(longer, 2.0 * now) || std::abs(*of_longer / *share / (longer.size / now) - 1.0) > proportional) {
    follower.linearize_at(from);
    return "";
  }
  std::string text =
      "the release from contact becomes tangential: all flights shrink to nothing, and beyond it the orbit "
      "stays in contact";
  const std::vector<Limit> limits = limits_of_parameters(follower, system, from, what, largest_of_limit * now, now);
  for (std::size_t i = 0; i < limits.size(); ++i)
    text += fmt::format("{}{} = {} +- {:.0e}", i > 0 ? ", " : "; that is at ",
                        system.system().parameter_name(system.free_parameters()[i]),
                        known_digits(limits[i].value, limits[i].uncertainty), limits[i].uncertainty);
  return text;
}

}  // namespace tchat

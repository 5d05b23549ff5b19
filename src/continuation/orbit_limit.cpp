#include "continuation/orbit_limit.hpp"

#include <array>
#include <cmath>
#include <span>

#include "base/levels.hpp"
#include "stability/curve_tests.hpp"

namespace tchat {

namespace {

/// The point with this amplitude near `from`.
std::optional<PathPoint> with_amplitude(PathFollower& follower, int orbits, const PathPoint& from,
                                        const OrbitTrend& trend, double wanted) {
  constexpr double as_expected = 0.5;  // relatively: the tangent knows amplitudes to their square
  constexpr double alike = 0.8;        // cosine: the same orbit, not begun half a turn later
  const double growth = deviation_growth(from.orbit, from.tangent.states, orbits);
  const double ds = (wanted / trend.amplitude(from.orbit) - 1.0) / growth;
  PathPoint found = from;
  if (!std::isfinite(ds) || !follower.step(from, ds, found).converged()) return std::nullopt;
  if (!(std::abs(trend.amplitude(found.orbit) - wanted) <= as_expected * wanted)) return std::nullopt;
  if (deviation_cosine(from.orbit, found.orbit, orbits) < alike) return std::nullopt;
  return found;
}

/// The limit of PAR(k) as the amplitude a goes to 0, from the polynomial in a^2 through three orbits; nothing where
/// that does not converge.
std::optional<double> limit_of_parameter(std::span<const Orbit> orbits, std::span<const double> amplitudes, int k) {
  constexpr double converges = 0.1;  // what the third orbit adds, as a share of what the parameter changes at all
  const auto value = [&](std::size_t i) { return orbits[i].par(k - 1); };
  const auto between = [&](std::size_t i, std::size_t j, double a, double b) {
    const double x = std::pow(amplitudes[i], 2), y = std::pow(amplitudes[j], 2);
    return (x * b - y * a) / (x - y);
  };
  const double of_larger = between(0, 1, value(0), value(1));
  const double of_smaller = between(1, 2, value(1), value(2));
  const double limit = between(0, 2, of_larger, of_smaller);
  const bool is_certain =
      std::abs(limit - of_smaller) <= converges * std::abs(limit - value(0)) + orbit_accuracy * std::abs(limit);
  return is_certain ? std::optional(limit) : std::nullopt;
}

/// Gives x the free parameters of the end, all of them or none.
void put_limits(PathFollower& follower, const DefiningSystem& system, const PathPoint& from, const OrbitTrend& trend,
                Orbit& x) {
  constexpr std::array shares = {0.02, 0.014, 0.008};
  std::vector<Orbit> orbits;
  std::vector<double> amplitudes;
  for (const double share : shares) {
    const std::optional<PathPoint> point = with_amplitude(follower, 1, from, trend, share);
    if (!point) return;
    orbits.push_back(point->orbit);
    amplitudes.push_back(trend.amplitude(point->orbit));
  }
  std::vector<double> limits;
  for (const int k : system.free_parameters()) {
    const std::optional<double> limit = limit_of_parameter(orbits, amplitudes, k);
    if (!limit) return;
    limits.push_back(*limit);
  }
  for (std::size_t i = 0; i < limits.size(); ++i) x.par(system.free_parameters()[i] - 1) = limits[i];
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

std::optional<PathPoint> smallest_orbit(PathFollower& follower, const DefiningSystem& system, const PathPoint& from,
                                        const OrbitTrend& trend) {
  const OrbitCondition* condition = follower.condition();
  const bool are_folds = condition != nullptr && condition->count() == 1 && condition->kept_multiplier() == 1;
  const bool is_branch = condition == nullptr && system.free_count() == 1 && follower.held().empty();
  const bool are_tori = system.orbits() > 1;
  if (!are_tori && (!is_smooth(system) || !(is_branch || are_folds))) return std::nullopt;
  constexpr std::array of_folds = {1e-2, 2e-3, 5e-4};
  constexpr std::array of_branch = {1e-2, 1e-3, level::visible, level::same};
  const std::span<const double> shares = are_folds ? std::span<const double>(of_folds) : of_branch;
  PathPoint here = from;
  double reached = 1.0;
  for (const double wanted : shares) {
    std::optional<PathPoint> next = with_amplitude(follower, system.orbits(), here, trend, wanted);
    if (!next) break;
    here = *std::move(next);
    reached = wanted;
  }
  constexpr double small_enough = 2e-3;
  if (reached > small_enough) return std::nullopt;
  if (are_folds) put_limits(follower, system, from, trend, here.orbit);
  return here;
}

}  // namespace tchat

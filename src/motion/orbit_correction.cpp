#include "motion/orbit_correction.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double tolerance_of_turns = level::converged;
constexpr double tolerance_far = level::differences;
constexpr double far_from_orbit = 1e-3;   // in scales
constexpr double noise_of_turns = 100.0;  // tolerances, of R(y)
constexpr int most_newton_steps = 10;
constexpr double farthest = 2000.0;  // of a Newton step, in scales
constexpr double newton_converged = level::tolerance;
constexpr double rough_step = 1e-3;   // enough where R(y) - y is noise already
constexpr double least_range = 1e-3;  // of an orbit, in scales
constexpr double doubtful = 1e-2;     // distance of a modulus from 1 that two tolerances are compared for
constexpr double least_uncertainty = level::differences;
constexpr double linear = level::visible;  // distance, in scales, in which one turn tells
constexpr double wanted_decay = 0.25;      // 1 - |mu| summed over the turns that are watched
constexpr double most_turns = 128.0;
constexpr std::size_t least_passed = 8;       // turns that the motion has made
constexpr std::size_t turns_of_leaving = 16;  // at least
constexpr double growth_of_leaving = 100.0;   // in them
constexpr double growth_of_movement = 10.0;   // in them, at least
constexpr double spreading = 1.5;             // modulus of a multiplier
constexpr double like_growth = 0.2;
constexpr double noticeable = 0.05;                             // fall of V in them
constexpr double shares_of_distance[] = {1.0, 0.3, 0.1, 0.02};  // of the motion's, that turns begin from

SimulationSettings accurate(SimulationSettings settings, double tolerance) {
  settings.flow.relative_tolerance = std::min(settings.flow.relative_tolerance, tolerance);
  settings.flow.absolute_tolerance = std::min(settings.flow.absolute_tolerance, 0.01 * tolerance);
  return settings;
}

double size_of(const OrbitCandidate& candidate, const VectorXd& d) {
  double largest = 0.0;
  for (Index i = 0; i < d.size(); ++i)
    if (d(i) != 0.0) largest = std::max(largest, std::abs(d(i)) / candidate.scale(i));
  return largest;
}

double noise(const OrbitCandidate& candidate) {
  return noise_of_turns * std::min(candidate.settings.flow.relative_tolerance, tolerance_of_turns);
}

VectorXd without_ignorable(const OrbitCandidate& candidate, VectorXd d) {
  for (const Index k : candidate.ignorable) d(k) = 0.0;
  return d;
}

/// Onto the surface h = 0 of the event that the motion has met.
VectorXd on_surface(const OrbitCandidate& candidate, const VectorXd& y) {
  return onto_surface(candidate.motion.system(), candidate.signature.back().event, no_function, y,
                      candidate.motion.parameters().data(), candidate.motion.sizes())
      .value_or(y);
}

SimulatedTurn turn_from(const OrbitCandidate& candidate, const VectorXd& y, double tolerance, bool with_derivative) {
  SimulationSettings settings = accurate(candidate.settings, tolerance);
  settings.samples = 0;
  settings.sections.clear();
  return simulate_turn(candidate.motion, y, candidate.signature, settings, with_derivative);
}

/// Far from the orbit turns need fewer digits. A motion that has come near it begins with all.
double tolerance_at(double distance) { return distance <= far_from_orbit ? tolerance_of_turns : tolerance_far; }

/// Between the ends of two turns that the motion has made, so many turns ago; 0 where it has not made so many.
double movement(const OrbitCandidate& candidate, std::size_t ago) {
  const std::vector<VectorXd>& passed = candidate.passed;
  if (passed.size() < ago + 2) return 0.0;
  const VectorXd& last = passed[passed.size() - ago - 1];
  return size_of(candidate, without_ignorable(candidate, last - passed[passed.size() - ago - 2]));
}

/// Turns far from an orbit that spread: where the motion does not leave one, what Newton's method would find does not
/// attract.
bool is_hopeless(const OrbitCandidate& candidate, double largest) {
  const double before = movement(candidate, turns_of_leaving), now = movement(candidate, 0);
  const bool may_leave = before > 0.0 && now >= growth_of_movement * before;
  return now > far_from_orbit && largest > spreading && !may_leave;
}

/// A turn whose parts are alike is no turn: the orbit is a shorter one.
bool is_repeated(const OrbitCandidate& candidate, const SimulatedTurn& turn) {
  const std::size_t m = turn.segments.size();
  for (std::size_t q = 1; q < m; ++q) {
    if (m % q != 0) continue;
    bool repeats = true;
    for (std::size_t s = 0; repeats && s < m; ++s) {
      const SimulatedSegment& a = turn.segments[s];
      const SimulatedSegment& b = turn.segments[(s + q) % m];
      const VectorXd d = without_ignorable(candidate, a.end - b.end);
      repeats = a.index == b.index && size_of(candidate, d) <= rough_step;
    }
    if (repeats) return true;
  }
  return false;
}

/// A motion that comes to rest turns in ever smaller circles. Newton's method converges to the equilibrium, or to
/// rounding beside it, where no state moves by a share of its size that integration resolves.
bool is_at_rest(const OrbitCandidate& candidate, const SimulatedTurn& turn) {
  VectorXd low = turn.segments.front().low, high = turn.segments.front().high;
  for (const SimulatedSegment& segment : turn.segments) {
    low = low.cwiseMin(segment.low);
    high = high.cwiseMax(segment.high);
  }
  const VectorXd range = without_ignorable(candidate, high - low);
  return size_of(candidate, range) <= least_range || length_in_sizes(range, candidate.motion.sizes()) <= level::orbit;
}

double largest_modulus(const std::vector<std::complex<double>>& multipliers) {
  return multipliers.empty() ? 0.0 : std::abs(multipliers.front());
}

/// Difference of the largest modulus between two tolerances.
double uncertainty_of(const OrbitCandidate& candidate, const CorrectedOrbit& orbit) {
  const double largest = largest_modulus(orbit.multipliers);
  if (std::abs(largest - 1.0) > doubtful) return least_uncertainty;
  const SimulatedTurn rough = turn_from(candidate, orbit.end, 10.0 * tolerance_of_turns, true);
  if (!rough.fault.empty()) return doubtful;
  const double other = largest_modulus(multipliers_without(rough.derivative, candidate.ignorable));
  return std::max(least_uncertainty, 2.0 * std::abs(largest - other));
}

/// V(d) = d' W d of distances d from the orbit, along turns of the motion.
class ApproachTest {
 public:
  ApproachTest(const OrbitCandidate& candidate, const CorrectedOrbit& orbit)
      : candidate_(candidate), orbit_(orbit), map_(orbit.turn.derivative) {
    for (const Index k : candidate.ignorable) map_.row(k).setZero(), map_.col(k).setZero();
    weight_ = decay_weight(map_, candidate.scale);
  }

  bool has_weight() const { return weight_.allFinite(); }

  /// Has V fallen to less than half of what it was, in the turns that the motion has made?
  bool has_decayed() const {
    const std::vector<VectorXd>& passed = candidate_.passed;
    if (passed.size() < least_passed) return false;
    std::vector<VectorXd> seen;
    for (const VectorXd& y : passed) seen.push_back(distance(y));
    return mean(seen, seen.size() - seen.size() / 4) < 0.5 * mean(seen, 0) && falls_as_predicted(seen);
  }

  /// Does V fall in turns from y?
  bool decays_from(VectorXd y) const {
    const double gap = 1.0 - largest_modulus(orbit_.multipliers);
    const int turns = 2 * static_cast<int>(std::clamp(0.5 * wanted_decay / gap, 4.0, 0.5 * most_turns));
    std::vector<VectorXd> seen{distance(y)};
    for (int k = 0; k < turns; ++k) {
      const SimulatedTurn turn = turn_from(candidate_, y, tolerance_of_turns, false);
      if (!turn.fault.empty()) return false;
      y = turn.end();
      seen.push_back(distance(y));
    }
    return falls_as_predicted(seen);
  }

 private:
  VectorXd distance(const VectorXd& y) const { return without_ignorable(candidate_, y - orbit_.end); }

  /// At half the rate at which M lowers V, at least: where that is noticeable, from the mean over the first quarter of
  /// the turns to that over the last, unless no distance is left; otherwise in every two turns.
  bool falls_as_predicted(const std::vector<VectorXd>& seen) const {
    std::vector<VectorXd> linear_ones{seen.front()};
    while (linear_ones.size() < seen.size()) linear_ones.push_back(map_ * linear_ones.back());
    const double expected = ratio_of_means(linear_ones);
    if (expected < 1.0 - noticeable)
      return ratio_of_means(seen) <= std::sqrt(expected) || size_of(candidate_, seen.back()) <= noise(candidate_);
    for (std::size_t k = 2; k < seen.size(); ++k)
      if (fall(seen[k - 2], seen[k]) < 0.5 * fall(seen[k - 2], map_ * map_ * seen[k - 2])) return false;
    return true;
  }

  /// V(before) - V(after)
  double fall(const VectorXd& before, const VectorXd& after) const {
    return (before - after).dot(weight_ * (before + after));
  }
  /// Of a quarter of the turns.
  double mean(const std::vector<VectorXd>& distances, std::size_t from) const {
    const std::size_t quarter = distances.size() / 4;
    double sum = 0.0;
    for (std::size_t k = from; k < from + quarter; ++k) sum += distances[k].dot(weight_ * distances[k]);
    return sum / static_cast<double>(quarter);
  }
  /// That over the last quarter as a share of that over the first.
  double ratio_of_means(const std::vector<VectorXd>& distances) const {
    return mean(distances, distances.size() - distances.size() / 4) / mean(distances, 0);
  }

  const OrbitCandidate& candidate_;
  const CorrectedOrbit& orbit_;
  MatrixXd map_, weight_;
};

constexpr double singular = level::visible;       // Id - M, of its largest singular value
constexpr double shares_beside[] = {0.05, 0.01};  // of the scale
constexpr double closed_turn = 10.0;              // noise of turns
constexpr int most_beside = 8;                    // steps of Newton's method

/// Turns beside a state, in units of the candidate's scale.
class TurnsBeside {
 public:
  TurnsBeside(const OrbitCandidate& candidate, const VectorXd& y, double uncertainty)
      : candidate_(candidate), units_(candidate.scale.unaryExpr(&size_for_tolerance)), centre_(y) {
    for (const Index k : candidate.ignorable) units_(k) = 1.0;
    const std::optional<Turn> turn = turn_of(centre_);
    if (!turn) return;
    const SingularVectors found = singular_vectors(turn->matrix);
    is_known_ = found.sizes.allFinite();
    const double null = std::max(singular, 10.0 * uncertainty);
    const Index nulls = is_known_ ? (found.sizes.array() <= null * found.sizes(0)).count() : 0;
    right_ = found.right.rightCols(nulls);
    left_ = found.left.rightCols(nulls);
  }

  bool is_known() const { return is_known_; }
  Index nulls() const { return right_.cols(); }

  /// |g| of the state that lies s beside in direction k, nothing where there is none.
  std::optional<double> movement(Index k, double s) const {
    const Index n = centre_.size(), m = nulls();
    VectorXd z = s * right_.col(k), g = VectorXd::Zero(m);
    for (int step = 0; step < most_beside; ++step) {
      const std::optional<Turn> turn = turn_of(centre_ + units_.cwiseProduct(z));
      if (!turn) return std::nullopt;
      MatrixXd matrix = MatrixXd::Zero(n + m, n + m);
      matrix << turn->matrix, left_, right_.transpose(), MatrixXd::Zero(m, m);
      VectorXd right(n + m);
      right << turn->residual - left_ * g, s * VectorXd::Unit(m, k) - right_.transpose() * z;
      const VectorXd change = solve_with_complete_pivoting(matrix, right);
      z += change.head(n);
      g += change.tail(m);
      if (!(z.norm() <= 3.0 * std::abs(s))) return std::nullopt;
      if (change.norm() <= newton_converged * std::abs(s)) return g.norm();
    }
    return std::nullopt;
  }

 private:
  struct Turn {
    MatrixXd matrix;    // Id - M
    VectorXd residual;  // R(y) - y
  };

  std::optional<Turn> turn_of(const VectorXd& y) const {
    const SimulatedTurn turn = turn_from(candidate_, y, tolerance_of_turns, true);
    if (!turn.fault.empty()) return std::nullopt;
    const VectorXd inverse = units_.cwiseInverse();
    Turn found{MatrixXd::Identity(y.size(), y.size()) - inverse.asDiagonal() * turn.derivative * units_.asDiagonal(),
               inverse.cwiseProduct(without_ignorable(candidate_, turn.end() - y))};
    for (const Index k : candidate_.ignorable) found.matrix.row(k) = VectorXd::Unit(y.size(), k).transpose();
    return found;
  }

  const OrbitCandidate& candidate_;
  VectorXd units_, centre_;
  MatrixXd right_, left_;  // null vectors, n x m
  bool is_known_ = false;
};

}  // namespace

Neighbours neighbours_of(const OrbitCandidate& candidate, const VectorXd& y, double uncertainty) {
  const TurnsBeside turns(candidate, y, uncertainty);
  if (!turns.is_known()) return Neighbours::open;
  if (turns.nulls() == 0) return Neighbours::isolated;
  const double allowed = closed_turn * noise(candidate);
  const auto closes = [&](Index k, double sign) {
    return std::any_of(std::begin(shares_beside), std::end(shares_beside), [&](double share) {
      const std::optional<double> moved = turns.movement(k, sign * share);
      return moved && *moved <= allowed;
    });
  };
  for (Index k = 0; k < turns.nulls(); ++k)
    if (!closes(k, 1.0) || !closes(k, -1.0)) return Neighbours::open;
  return Neighbours::closed;
}

MatrixXd decay_weight(MatrixXd m, const VectorXd& scale) {
  constexpr double vanished = std::numeric_limits<double>::min();
  constexpr int most_doublings = 60;  // W_2k = W_k + (M^k)' W_k M^k
  MatrixXd w = scale.unaryExpr([](double s) { return s > 0.0 ? std::pow(s, -2) : 0.0; }).asDiagonal();
  for (int k = 0; k < most_doublings && w.allFinite() && m.cwiseAbs().maxCoeff() > vanished; ++k) {
    w = (w + m.transpose() * w * m).eval();
    m = (m * m).eval();
  }
  return w;
}

SimulatedTurn turn_of(const OrbitCandidate& candidate, const VectorXd& y) {
  return simulate_turn(candidate.motion, y, candidate.signature, accurate(candidate.settings, tolerance_of_turns),
                       false);
}

CorrectedOrbit correct_orbit(const OrbitCandidate& candidate) {
  CorrectedOrbit orbit;
  orbit.end = candidate.end;
  double last_step = INFINITY, last_modulus = 0.0;
  for (int step = 0;; ++step) {
    const double distance = step == 0 ? movement(candidate, 0) : last_step;
    orbit.turn = turn_from(candidate, orbit.end, tolerance_at(distance), true);
    if (!orbit.turn.fault.empty()) {
      orbit.is_smooth = step > 0 || orbit.turn.is_smooth;
      orbit.fault = orbit.turn.fault;
      return orbit;
    }
    if (step == 0) orbit.passed = orbit.turn.end();
    const VectorXd residual = without_ignorable(candidate, orbit.turn.end() - orbit.end);
    last_modulus = largest_modulus(orbit.multipliers);
    orbit.multipliers = multipliers_without(orbit.turn.derivative, candidate.ignorable);
    if (step == 0 && is_hopeless(candidate, largest_modulus(orbit.multipliers))) {
      orbit.fault = "no stable periodic orbit near the motion";
      return orbit;
    }
    const bool is_noise = size_of(candidate, residual) <= noise(candidate);
    const VectorXd dy = closing_step(orbit.turn.derivative, residual, candidate.ignorable, candidate.motion.sizes());
    const double size = size_of(candidate, dy);
    const bool is_rough = is_noise && last_step <= rough_step && !(size < 0.25 * last_step);
    if (last_step <= newton_converged || is_rough) break;
    if (step == most_newton_steps || !(size < farthest) || (step > 1 && size > 2.0 * last_step)) {
      orbit.fault = "no periodic orbit near the motion";
      return orbit;
    }
    last_step = size;
    orbit.end = on_surface(candidate, orbit.end + dy);
  }
  if (is_repeated(candidate, orbit.turn)) {
    orbit.fault = "the orbit near the motion is shorter";
    return orbit;
  }
  if (is_at_rest(candidate, orbit.turn)) {
    orbit.fault = "the trajectory converges to an equilibrium";
    return orbit;
  }
  const double last_change = std::abs(largest_modulus(orbit.multipliers) - last_modulus);
  orbit.uncertainty = std::max(uncertainty_of(candidate, orbit), last_change);
  orbit.converged = true;
  return orbit;
}

bool approaches(const OrbitCandidate& candidate, const CorrectedOrbit& orbit) {
  if (size_of(candidate, without_ignorable(candidate, orbit.passed - candidate.end)) <= noise(candidate)) return true;
  const ApproachTest test(candidate, orbit);
  if (!test.has_weight()) return false;
  if (test.has_decayed()) return true;
  const VectorXd distance = without_ignorable(candidate, candidate.end - orbit.end);
  for (const double share : shares_of_distance) {
    if (share < 1.0 && share * size_of(candidate, distance) <= linear) return true;
    if (!test.decays_from(share < 1.0 ? on_surface(candidate, orbit.end + share * distance) : candidate.end))
      return false;
  }
  return true;
}

bool is_leaving(const OrbitCandidate& candidate, const CorrectedOrbit& orbit) {
  const double growth = largest_modulus(orbit.multipliers);
  const auto wanted = static_cast<std::size_t>(std::min(std::log(growth_of_leaving) / std::log(growth), 1e6));
  const std::size_t turns = std::min(std::max(wanted, turns_of_leaving), candidate.passed.size() - 1);
  if (turns < turns_of_leaving) return false;
  const auto distance = [&](std::size_t k) -> VectorXd {
    return without_ignorable(candidate, candidate.passed[k] - orbit.end);
  };
  const std::size_t last = candidate.passed.size() - 1;
  for (std::size_t k = last - turns; k < last; ++k) {
    const VectorXd expected = without_ignorable(candidate, orbit.turn.derivative * distance(k));
    if (!(size_of(candidate, distance(k + 1) - expected) <= like_growth * size_of(candidate, expected))) return false;
  }
  const double expected = static_cast<double>(turns) * std::log(growth);
  return std::log(size_of(candidate, distance(last)) / size_of(candidate, distance(last - turns))) >= 0.5 * expected;
}

}  // namespace tchat

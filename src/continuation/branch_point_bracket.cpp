#include "continuation/branch_point_bracket.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/levels.hpp"
#include "continuation/path_follower.hpp"

namespace tchat {

namespace {

/// Each round puts a trial point on both sides of the expected zero, at this share of the bracket: farther away when no
/// step so close to the zero converges.
constexpr double smallest_share = 0.1;
constexpr double largest_share = 0.4;
constexpr int most_rounds = 20;
/// The least share of a move that the next one is trusted to be: two places that agree more closely do so by chance.
constexpr double least_move = 0.01;
/// That is asked for as long as the bracket is wider than this share of the step: across a narrow one rounding decides
/// on the direction in which the branch goes on.
constexpr double wide = 1e-3;
/// Rounds in a row in which the place moves more than before.
constexpr int most_worse = 2;
/// Share of the step that counts as one place for other functions that vanish there.
constexpr double narrow_enough = 0.01;
/// To find where the function has the sign that it brought into the step, after a zero at its start.
constexpr int most_halvings = 12;
constexpr std::size_t most_nodes = 4;
/// The best that is asked for where rounding and Newton's tolerances forbid more: an arclength, or a share of the step.
constexpr double reachable = level::tolerance;
constexpr double reachable_share = level::same;
/// Around a zero the function changes by a smaller share than this of its change over the step; at a jump it does not.
constexpr double jump_share = 0.5;

}  // namespace

BranchPointBracket::BranchPointBracket(PathFollower& follower, const PathPoint& start, const PointData& start_data,
                                       const Candidate& end, std::size_t test, int sign)
    : follower_(follower),
      start_(start),
      test_(test),
      sign_(sign),
      direction_(end.ds < 0.0 ? -1.0 : 1.0),
      low_(make_side(0.0, start, start_data)),
      high_(make_side(std::abs(end.ds), end.point, end.data)),
      nodes_{{low_.at, low_.value}, {high_.at, high_.value}} {}

BranchPointBracket::Side BranchPointBracket::make_side(double at, const PathPoint& point, const PointData& data) const {
  Side side{at, data.tests[test_].value.value_or(0.0), point.orbit, point.tangent, data};
  side.slope.scale(direction_ / dot(start_.dual, point.tangent));
  return side;
}

bool BranchPointBracket::narrow(const Evaluate& evaluate, PathPoint& trial, double tolerance) {
  const double whole = high_.at;
  if (!find_sign(evaluate, trial)) return false;
  const double change = high_.value - low_.value;
  const double least = std::max({tolerance, reachable, reachable_share * whole});
  double share = smallest_share;
  double moved = whole;
  double error = std::numeric_limits<double>::infinity();
  int worse = 0;
  Located best;
  for (int round = 0; round < most_rounds; ++round) {
    const double last = zero_;
    zero_ = interpolated_zero();
    if (round > 0) {
      const double before = std::exchange(moved, std::abs(zero_ - last));
      const bool is_wide = high_.at - low_.at > wide * whole;
      error = is_wide ? std::max(moved, least_move * before) : moved;
    }
    if (error <= best.error && high_.at - low_.at <= narrow_enough * whole) {
      best = {error, moved, zero_, low_, high_};
      put_zero(trial);
      if (error <= tolerance && follower_.solves(trial.orbit)) break;
      worse = 0;
    } else if (best.error <= tolerance || (best.moved <= least && ++worse == most_worse)) {
      break;
    }
    const double before = high_.at - low_.at;
    const double distance = share * before;
    const double below = zero_ - distance;
    const double above = zero_ + distance;
    bool narrowed = try_at(below, evaluate, trial);
    narrowed = try_at(above, evaluate, trial) || narrowed;
    // Values over many decades are no polynomial.
    if (narrowed && high_.at - low_.at > 0.5 * before) try_at(0.5 * (low_.at + high_.at), evaluate, trial);
    if (narrowed) continue;
    if (share >= largest_share) break;
    share *= 2.0;
  }
  if (best.moved > least) return false;
  zero_ = best.zero;
  low_ = std::move(best.low);
  high_ = std::move(best.high);
  return std::abs(high_.value - low_.value) <= jump_share * std::abs(change);
}

/// At a zero located before, the function lacks the sign that the branch had there.
bool BranchPointBracket::find_sign(const Evaluate& evaluate, PathPoint& trial) {
  for (int halving = 0; low_.data.tests[test_].sign != sign_; ++halving) {
    if (halving == most_halvings) return false;
    if (!try_at(0.5 * (low_.at + high_.at), evaluate, trial)) return false;
  }
  return true;
}

/// A trial point inside the bracket, which takes the place of one of its ends. False when there is none.
bool BranchPointBracket::try_at(double at, const Evaluate& evaluate, PathPoint& trial) {
  if (!(at > low_.at && at < high_.at)) return false;
  put(at, trial);
  if (!follower_.step_beside_branch_point(start_, direction_ * at, trial).converged()) return false;
  const PointData data = evaluate(trial);
  if (!data.tests[test_].value) return false;
  Side side = make_side(at, trial, data);
  nodes_.push_back({at, side.value});
  (side.value * sign_ > 0.0 ? low_ : high_) = std::move(side);
  return true;
}

/// Of the polynomial through the ends of the bracket and the points nearest to it.
double BranchPointBracket::interpolated_zero() const {
  const double middle = 0.5 * (low_.at + high_.at);
  std::vector<Node> nodes = nodes_;
  std::sort(nodes.begin(), nodes.end(),
            [&](const Node& a, const Node& b) { return std::abs(a.at - middle) < std::abs(b.at - middle); });
  nodes.resize(std::min(nodes.size(), most_nodes));
  const auto polynomial = [&](double at) {
    double result = 0.0;
    for (const Node& i : nodes) {
      double term = i.value;
      for (const Node& k : nodes)
        if (k.at != i.at) term *= (at - k.at) / (i.at - k.at);
      result += term;
    }
    return result;
  };
  double low = low_.at;
  double high = high_.at;
  for (int halving = 0; halving < 60; ++halving) {
    const double half = 0.5 * (low + high);
    (polynomial(half) * sign_ > 0.0 ? low : high) = half;
  }
  return 0.5 * (low + high);
}

void BranchPointBracket::put(double at, PathPoint& point) const {
  const std::vector<int>& free = follower_.condensed().system().free_parameters();
  const double h = high_.at - low_.at;
  const double s = (at - low_.at) / h;
  OrbitVector across = low_.slope;  // from low to high
  across.states = high_.orbit.states - low_.orbit.states;
  for (int k = 0; k < low_.orbit.shape.segments; ++k)
    across.durations(k) = high_.orbit.duration(k) - low_.orbit.duration(k);
  for (std::size_t g = 0; g < free.size(); ++g)
    across.globals(static_cast<Eigen::Index>(g)) = high_.orbit.par(free[g] - 1) - low_.orbit.par(free[g] - 1);
  point.orbit = low_.orbit;
  advance(point.orbit, s * s * (3.0 - 2.0 * s), across, free);
  advance(point.orbit, h * s * (1.0 - s) * (1.0 - s), low_.slope, free);
  advance(point.orbit, h * s * s * (s - 1.0), high_.slope, free);

  const double by_low = direction_ * (1.0 - s) * (1.0 - 3.0 * s);
  const double by_high = direction_ * s * (3.0 * s - 2.0);
  across.scale(direction_ * 6.0 * s * (1.0 - s) / h);
  point.tangent.states = across.states + by_low * low_.slope.states + by_high * high_.slope.states;
  point.tangent.durations = across.durations + by_low * low_.slope.durations + by_high * high_.slope.durations;
  point.tangent.globals = across.globals + by_low * low_.slope.globals + by_high * high_.slope.globals;
  follower_.renormalise(point);
  follower_.monitors().store(point.orbit, follower_.condensed().rule());
}

namespace {

/// The next value may miss the extrapolation by this share of the largest one.
constexpr double unexpected = 0.3;
/// Below this share of the values at the ends of the step, what lies in between is near to zero.
constexpr double dip = 0.25;
constexpr int looks = 16;  // for a dip
/// Points closer together than this share of the step (a located special point and its neighbour) tell no trend.
constexpr double apart_enough = 0.2;
constexpr std::size_t most_past = 3;

/// Some of the values, and the next one: those of a cubic.
struct ChosenValues {
  std::array<TrendValue, most_past + 1> list{};
  std::size_t count = 0;
  void add(const TrendValue& one) { list[count++] = one; }
  std::span<const TrendValue> all() const { return {list.data(), count}; }
};

/// The last value, the last one before it that is at least `spacing` away, and so on.
ChosenValues last_ones(std::span<const TrendValue> values, double spacing) {
  ChosenValues chosen;
  for (auto one = values.rbegin(); one != values.rend() && chosen.count < most_past; ++one)
    if (chosen.count == 0 || std::abs(one->at - chosen.list[chosen.count - 1].at) >= spacing) chosen.add(*one);
  return chosen;
}

/// The polynomial through some values, by divided differences.
class Interpolation {
 public:
  explicit Interpolation(std::span<const TrendValue> values) : count_(values.size()) {
    for (std::size_t i = 0; i < count_; ++i) {
      places_[i] = values[i].at;
      differences_[i] = values[i].value;
    }
    for (std::size_t level = 1; level < count_; ++level)
      for (std::size_t i = count_; i-- > level;) {
        const double width = places_[i] - places_[i - level];
        differences_[i] = width != 0.0 ? (differences_[i] - differences_[i - 1]) / width : 0.0;
      }
  }

  double operator()(double at) const {
    double result = 0.0;
    for (std::size_t i = count_; i-- > 0;) result = result * (at - places_[i]) + differences_[i];
    return result;
  }

 private:
  std::size_t count_;
  std::array<double, most_past + 1> places_{};
  std::array<double, most_past + 1> differences_{};
};

/// Between two values of one sign, does the polynomial through `values` fall below this share of the smaller one?
bool falls_below(double share, std::span<const TrendValue> values, const TrendValue& last, const TrendValue& next) {
  if (!(last.value * next.value > 0.0)) return false;
  const Interpolation polynomial(values);
  const double sign = next.value > 0.0 ? 1.0 : -1.0;
  const double least = share * std::min(std::abs(last.value), std::abs(next.value));
  for (int k = 1; k < looks; ++k)
    if (sign * polynomial(last.at + (next.at - last.at) * k / looks) < least) return true;
  return false;
}

}  // namespace

bool follows_trend(std::span<const TrendValue> past, const TrendValue& next) {
  if (past.empty()) return true;
  ChosenValues values = last_ones(past, apart_enough * std::abs(next.at - past.back().at));
  if (values.count < 2) return true;
  double size = std::abs(next.value);
  for (const TrendValue& one : past) size = std::max(size, std::abs(one.value));
  if (std::abs(Interpolation(values.all())(next.at) - next.value) > unexpected * size) return false;
  values.add(next);
  return !falls_below(dip, values.all(), past.back(), next);
}

bool has_two_zeros(std::span<const TrendValue> past, const TrendValue& next) {
  if (past.empty()) return false;
  ChosenValues values = last_ones(past, apart_enough * std::abs(next.at - past.back().at));
  if (values.count < most_past) return false;
  values.add(next);
  if (!falls_below(0.0, values.all(), past.back(), next)) return false;
  ChosenValues parabola;  // the newest come first
  for (std::size_t i = 0; i + 1 < most_past; ++i) parabola.add(values.list[i]);
  parabola.add(next);
  return falls_below(0.0, parabola.all(), past.back(), next);
}

}  // namespace tchat

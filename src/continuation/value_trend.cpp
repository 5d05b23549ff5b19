#include "continuation/value_trend.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tchat {

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

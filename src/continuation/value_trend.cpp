#include "continuation/value_trend.hpp"

#include <algorithm>
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

/// The last value, the last one before it that is at least `spacing` away, and so on.
std::vector<TrendValue> last_ones(const std::vector<TrendValue>& values, double spacing) {
  std::vector<TrendValue> chosen;
  for (auto one = values.rbegin(); one != values.rend() && chosen.size() < most_past; ++one)
    if (chosen.empty() || std::abs(one->at - chosen.back().at) >= spacing) chosen.push_back(*one);
  return chosen;
}

/// Of the polynomial through all values.
double interpolate(const std::vector<TrendValue>& values, double at) {
  double result = 0.0;
  for (const TrendValue& one : values) {
    double term = one.value;
    for (const TrendValue& other : values)
      if (other.at != one.at) term *= (at - other.at) / (one.at - other.at);
    result += term;
  }
  return result;
}

/// Between two values of one sign, does the polynomial through `values` fall below this share of the smaller one?
bool falls_below(double share, const std::vector<TrendValue>& values, const TrendValue& last, const TrendValue& next) {
  if (!(last.value * next.value > 0.0)) return false;
  const double sign = next.value > 0.0 ? 1.0 : -1.0;
  const double least = share * std::min(std::abs(last.value), std::abs(next.value));
  for (int k = 1; k < looks; ++k)
    if (sign * interpolate(values, last.at + (next.at - last.at) * k / looks) < least) return true;
  return false;
}

}  // namespace

bool follows_trend(const std::vector<TrendValue>& past, const TrendValue& next) {
  if (past.empty()) return true;
  std::vector<TrendValue> values = last_ones(past, apart_enough * std::abs(next.at - past.back().at));
  if (values.size() < 2) return true;
  double size = std::abs(next.value);
  for (const TrendValue& one : past) size = std::max(size, std::abs(one.value));
  if (std::abs(interpolate(values, next.at) - next.value) > unexpected * size) return false;
  values.push_back(next);
  return !falls_below(dip, values, past.back(), next);
}

bool has_two_zeros(const std::vector<TrendValue>& past, const TrendValue& next) {
  if (past.empty()) return false;
  std::vector<TrendValue> values = last_ones(past, apart_enough * std::abs(next.at - past.back().at));
  if (values.size() < most_past) return false;
  values.push_back(next);
  std::vector<TrendValue> parabola(values.begin(), values.begin() + most_past - 1);  // the newest come first
  parabola.push_back(next);
  return falls_below(0.0, values, past.back(), next) && falls_below(0.0, parabola, past.back(), next);
}

}  // namespace tchat

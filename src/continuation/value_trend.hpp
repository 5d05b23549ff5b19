/// Do the values of a test function along a branch lie close enough together to see every change of sign?
///
/// The polynomial through earlier values foretells the next one, and tells with it what lies in between: two zeros
/// between two values of one sign; for a function that oscillates, a dip near to zero there, or a value far from what
/// was expected, is reason enough to look closer.
#pragma once

#include <span>

namespace tchat {

struct TrendValue {
  double at;  ///< arclength
  double value;
};

/// `past` in the order of the branch, `next` beyond its last one. With fewer than two values there is no trend, and any
/// next one follows it.
bool follows_trend(std::span<const TrendValue> past, const TrendValue& next);

/// Have the cubic through the last three values and the next one, and the parabola through the last two, two zeros
/// between the last one and the next? With fewer than three values there is no cubic.
bool has_two_zeros(std::span<const TrendValue> past, const TrendValue& next);

}  // namespace tchat

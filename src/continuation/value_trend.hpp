/// Do the values of an oscillating test function along a branch lie close enough together to see every change of sign?
///
/// The polynomial through earlier values foretells the next one, and tells with it what lies in between. Far from what
/// was expected, or with a dip near to zero between two values of one sign, the function may have changed sign twice.
#pragma once

#include <vector>

namespace tchat {

struct TrendValue {
  double at;  ///< arclength
  double value;
};

/// `past` in the order of the branch, `next` beyond its last one. With fewer than two values there is no trend, and any
/// next one follows it.
bool follows_trend(const std::vector<TrendValue>& past, const TrendValue& next);

}  // namespace tchat

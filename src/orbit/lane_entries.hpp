/// Numbers of one lane of arrays whose entries are `lanes` numbers side by side.
#pragma once

#include <algorithm>

#include "linear/lane_kernel.hpp"

namespace tchat {

/// `count` numbers of one lane from and to an array of their own.
inline void take_lane(const double* from, int lane, int count, double* to) {
  for (int k = 0; k < count; ++k) to[k] = from[k * lanes + lane];
}
inline void put_lane(const double* from, int count, int lane, double* to) {
  for (int k = 0; k < count; ++k) to[k * lanes + lane] = from[k];
}

/// The same number in all lanes.
inline void put_lanes(double value, double* to) { std::fill_n(to, lanes, value); }

}  // namespace tchat

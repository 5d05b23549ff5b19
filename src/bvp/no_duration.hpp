/// When a segment lasts no time.
#pragma once

#include <cmath>

#include "bvp/orbit.hpp"

namespace tchat {

/// Durations that are a smaller share of the period are zero: located points, where segments vanish, are known to about
/// ten times less (EPSS).
inline constexpr double no_duration = 1e-6;

/// Does segment s (from 0) last no time, but for the accuracy of a located point?
inline bool lasts_no_time(const Orbit& x, int s) {
  return std::abs(x.duration(s)) <= no_duration * std::abs(x.period());
}

}  // namespace tchat

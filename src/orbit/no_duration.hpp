/// When a segment lasts no time.
#pragma once

#include <cmath>

#include "orbit/orbit.hpp"

namespace tchat {

/// Durations that are a smaller share of the period are zero: located points, where segments vanish, are known to about
/// ten times less (EPSS).
inline constexpr double no_duration = 1e-6;

/// Does segment s (from 0) last no time, but for the accuracy of a located point?
inline bool lasts_no_time(const Orbit& x, int s, double period) {
  return std::abs(x.duration(s)) <= no_duration * std::abs(period);
}
/// The same where the period is not at hand, which is a sum over all segments.
inline bool lasts_no_time(const Orbit& x, int s) { return lasts_no_time(x, s, x.period()); }

/// A contact segment (model/contact_segment.hpp) that shrinks to nothing passes zero in proportion to the arclength,
/// so that a located point knows its duration to EPSS, which may be coarse. At a tangency a shorter one is zero.
inline constexpr double no_contact = 1e-4;

inline bool contact_lasts_no_time(const Orbit& x, int s) {
  return std::abs(x.duration(s)) <= no_contact * std::abs(x.period());
}

}  // namespace tchat

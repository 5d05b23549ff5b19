/// Where a branch of orbits ends that shrink to a point, or a curve of doubled orbits whose halves meet.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "continuation/orbit_trend.hpp"
#include "continuation/path_follower.hpp"

namespace tchat {

// Near a point at which orbits or tori are born (Hopf or torus bifurcation; on curves in two parameters a generalised
// Hopf point, or one on an event surface) parameters, durations and means of an orbit of the amplitude a are those of
// the point and c a^2 + d a^4 + ..., for another sign of a is the same orbit begun half a turn later. Newton's matrix
// is singular at a = 0 alone: at 1e-5 of the amplitudes before, the parameters are those of the point to 1e-10, and
// runs can still start. On a curve of folds, whose condition vanishes with a^2 for all orbits, rounding / a^2 is in the
// parameters: there they are taken from larger orbits, by the polynomial in a^2.

/// Something of an orbit that falls to zero along a branch.
struct Shrinking {
  std::function<double(const Orbit&)> size;
  std::function<double(const PathPoint&)> growth;           ///< d ln size / ds
  std::function<bool(const Orbit&, const Orbit&)> is_same;  ///< not passed to what lies beyond zero?
  std::function<double(const Orbit&)> argument;             ///< parameters are smooth functions of it at zero
};

/// Where steps along the branch towards a size have come.
struct Approach {
  PathPoint point;
  double length = 0.0;  ///< of the way, signed
  double size = 0.0;
  NewtonResult newton;  ///< of the last step
};

/// Steps from `from` until the size is `wanted` to a half, or until Newton's method fails beside zero. The follower's
/// linearisation is another one afterwards.
Approach approach(PathFollower& follower, const PathPoint& from, const Shrinking& what, double wanted);

/// The amplitude of OrbitTrend; orbits begun half a turn later are not passed to.
Shrinking shrinking_amplitude(const OrbitTrend& trend, int orbits);

/// Are the points of the curve folds, whose parameters near its end are taken from larger orbits?
bool is_curve_of_folds(PathFollower& follower);

struct SmallestOrbit {
  PathPoint point;
  /// Of the free parameters, in order, where they are those of the end, extrapolated; else empty.
  std::vector<double> uncertainties;
};

/// The point of the branch with the amplitude 1e-5, 5e-4 on curves of folds, as a share of the largest ones, or the
/// smallest that is found; on curves of folds with the free parameters of the end, which are not those of the orbit.
/// `from` is on the way there. Tori that touch a surface do so at the distance of their amplitude from the orbit that
/// they end at. Nothing where none is found, and on other curves. The follower's linearisation is another one
/// afterwards.
std::optional<SmallestOrbit> smallest_orbit(PathFollower& follower, const DefiningSystem& system, const PathPoint& from,
                                            const OrbitTrend& trend);

// Where an orbit with chatter (tchat_chatter) is released ever more tangentially, h''' -> 0 at the end of contact, its
// flights last a time in proportion to h''', and their limit a higher power of it: with it all flights are lost at
// once. Beyond it the orbit stays in contact.

/// Why a branch ends at `from`, its last point, if it is about to reach such an orbit, with the values of the free
/// parameters there; "" if it is not. If it is, the follower's linearisation is another one afterwards.
std::string tangent_release(PathFollower& follower, const DefiningSystem& system, const PathPoint& from);

/// Where the halves of doubled orbits meet, a curve of their folds meets its mirror image: all that the halves have in
/// common, free parameters too, are even functions of their difference d, y = y_0 + y_2 d^2 + O(d^4), so that
/// y_0 = y - d y' / 2. Newton's method leads to any point of the curve of doublings there. Makes x, located by a step
/// of the length ds from `from`, the orbit of the end. The follower's linearisation is another one afterwards.
void put_end_of_doubled_folds(PathFollower& follower, const DefiningSystem& system, const PathPoint& from, double ds,
                              Orbit& x);

}  // namespace tchat

/// Where a branch of orbits ends of itself: the mesh no longer resolves them, or a duration passes infinity or zero.
#pragma once

#include <string>

#include "continuation/point_data.hpp"

namespace tchat {

class DefiningSystem;

/// Which figure of accuracy exceeds `bound` (ERRMAX; 0: none does), with its value, or "". The figures are
///   - the estimated error of the orbit (orbit/collocation_rule.hpp),
///   - the structural multiplier, or the trivial one's distance from 1, where multipliers are computed,
///   - the factor exp(z) by which perturbations grow, or the flow grows or decays, on one mesh interval. Here z is
///     h T |Re lambda| with an eigenvalue lambda of f_x, where one of them grows by more than exp(1) on the interval,
///     or h T |d ln |f| / dt|, the lesser of the values at both ends. Collocation at c Gauss points has the relative
///     error (c!)^2 / ((2c)! (2c+1)!) z^(2c+1) of this factor. Where it exceeds 1, multipliers and durations are those
///     of the mesh. It counts for orbits with a multiplier outside of the unit circle: the others contract local
///     errors, as relaxation oscillations do. Of those only the decay of |f| on the last interval of a segment counts,
///     on which the time of the event depends.
std::string unresolved_by_mesh(const DefiningSystem& system, const Orbit& x, const PointData& data, double bound);

/// Rounding of the orbit is magnified by exp(this) on the way round: the integral of the largest growth rate of f_x,
/// where it is positive. Multipliers are known to about 1e-16 times that factor.
double growth_exponent(const DefiningSystem& system, const Orbit& x);

/// "" or that a segment ends at rest to within rounding, |f| T below 1e-12 of the states: its duration is not
/// determined.
std::string undetermined_duration(const DefiningSystem& system, const Orbit& x);

/// The period or the duration of a segment that has passed infinity on a step of signed length ds between two points,
/// or "". No orbits lie beyond.
std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds);

/// "" or that the period has passed zero, beyond the accuracy of a located point.
std::string passed_zero(const Orbit& from, const Orbit& to);

/// "" or that the duration of a segment has. That is grazing, which has a label of its own where the branch ends unless
/// GRSTOP = 0; a branch that begins at one may lead to the wrong side.
std::string passed_zero_segment(const Orbit& from, const Orbit& to);

}  // namespace tchat

/// The branches that cross at a point where several multipliers come to +1 together.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "continuation/path_follower.hpp"

namespace tchat {

// F(U) = 0 are the equations of a branch, U its unknowns with the free parameter, t its unit tangent at a branch point.
// Where a symmetry brings k > 1 multipliers to +1 together, F_U has the null vectors t, v_1 ... v_k. All branches
// through the point have their tangents in that space, and the terms of second and third order of F decide which
// combinations are tangents [Golubitsky, Stewart, Schaeffer 1988, XIII]: with three equal oscillators in a ring, three
// of a circle.
//
// They are found without these terms. From directions spread evenly over the v, steps of two lengths to both sides are
// corrected on the plane across it; a solution there that is not of the known branch is of one that crosses it, and its
// difference from the branch point, in terms of the v, is the tangent of that up to the step's length. It counts if a
// step along it leads back to it: near the point residuals are products of three small numbers, and Newton's method
// may end beside a solution. A branch that no direction leads to is missed: what is found is said to be found, not to
// be all.

/// v_1 ... v_k, of unit length in the branch's norm and orthogonal to one another and to t. One where the branch point
/// is simple. `point` has t; its linearisation becomes the follower's.
std::vector<PathPoint> null_directions(PathFollower& follower, const PathPoint& point);

/// A step of so many times DS along a direction: the solution that it leads to, nothing where there is none or it is of
/// the known branch.
using LeaveAlong = std::function<std::optional<Orbit>(const PathPoint& direction, double length)>;

/// The tangents of the branches that those steps lead to, each once, whatever its side; in an order that depends on
/// the branches alone. `null`: null_directions(), two or more.
std::vector<OrbitVector> crossing_tangents(PathFollower& follower, const std::vector<PathPoint>& null,
                                           const LeaveAlong& leave);

/// Turns a direction so that DS > 0 has a meaning: the first free parameter, else duration, else state at the start of
/// the orbit, that changes along it grows.
void orient(const DefiningSystem& system, const Orbit& x, OrbitVector& v);

/// v less its part along the tangent of the known branch, and what share of its length that leaves.
double take_off(const PathPoint& point, OrbitVector& v);

/// A right-hand side of no particular direction: what a nearly singular matrix makes of it is nearly a null vector.
/// Others are independent of it.
OrbitResidual any_right_hand_side(const CondensedSystem& condensed, int which = 0);

}  // namespace tchat

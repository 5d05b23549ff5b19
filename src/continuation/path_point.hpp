/// A point of a branch, with what the next step from it needs.
#pragma once

#include "continuation/path_trail.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

struct PathPoint {
  Orbit orbit;
  OrbitVector tangent;     ///< unit length
  OrbitVector dual;        ///< <tangent, .> on the orbit's mesh
  ConditionMemory memory;  ///< of a two-parameter curve's condition
  PathTrail trail = {};    ///< points before it
  /// Newton's second correction over the square of the first, from the tangent: the last that is known, 0 for none.
  double newton_constant = 0.0;
};

}  // namespace tchat

/// How well a computed orbit is known: the one level below which a value says nothing.
#pragma once

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// Relative error of a corrected orbit: Newton's method ends with 1e-12 to 1e-10, the discretisation adds its own.
/// Whatever is computed from the orbit is zero up to this share of the sizes that it is made of.
inline constexpr double orbit_accuracy = 1e-9;

/// The size of an event function, against which a value of it is small: the largest |h| at the mesh points of the whole
/// orbit, for on a segment that is about to vanish all of them are small. Of an equilibrium, whose h may be all there
/// is and small, what a change of the state by its own size makes of h.
double event_scale(const HybridSystem& system, const Orbit& x, int event);

/// How well states of the orbit are known, n entries: orbit_accuracy times the largest |x_k| over the orbit, and not
/// less than rounding of the largest of all states, for a state that is zero throughout shows nothing but rounding.
Eigen::VectorXd state_uncertainty(const Orbit& x);

}  // namespace tchat

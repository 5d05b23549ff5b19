/// How an orbit meets the section that ends a segment: h_x f there, negative where the event function falls through
/// zero.
#pragma once

#include <cmath>

#include "orbit/defining_system.hpp"
#include "orbit/orbit_accuracy.hpp"

namespace tchat {

/// |h_x f| / (|h_x| |f|) up to this is zero: grazing, or a section that the orbit touches. The sign of less says
/// nothing, nor does what has been divided by it.
inline constexpr double no_transversality = orbit_accuracy;
/// At a contact that was located as a zero of h, which is quadratic there, h_x f is known to the root of that (EPSS):
/// up to this share of |h_x| |f| the contact is tangent, more is a crossing.
inline constexpr double tangent_contact = 1e-5;

struct Crossing {
  double rate = 0.0;   ///< h_x f, the velocity of an impact when h is a distance
  double sizes = 0.0;  ///< |h_x| |f|

  /// h_x f / (|h_x| |f|), from -1 to 1; 0 when h_x or f vanishes.
  double transversality() const { return sizes > 0.0 ? rate / sizes : 0.0; }
  bool touches() const { return !(std::abs(transversality()) > no_transversality); }
};

/// At the end of segment s (from 0), with the gradient of the section there. Where no event ends it, nothing is
/// touched: the flow crosses at a right angle.
Crossing crossing_at_end(const DefiningSystem& system, const Orbit& x, int s);
/// Of an event's own surface.
Crossing crossing_of_event(const HybridSystem& system, int event, int field, const double* x, const double* par);

}  // namespace tchat

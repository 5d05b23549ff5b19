/// Segments that begin and end on one event surface, which the orbit only passes: a one-sided spring is touched and
/// left, a diode conducts for a while, a switch is on.
///
/// The state does not jump where such a segment begins, so that it is born at a tangency of the orbit before it: the
/// duration of the contact grows from zero like the square root of the parameter.
#pragma once

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"

namespace tchat {

/// Is `own`, where it follows `before`, such a segment? The jump of `before` leaves the states of its surface as they
/// are, and these lie on the surface on which `own` ends; the fields differ (else the surface only cuts the orbit).
/// Tried at generic states of the surface: false where the functions have no finite values at any of them.
bool is_contact_segment(const HybridSystem& system, const IndexVector& before, const IndexVector& own);

/// The same for segment s (from 0) of a cyclic signature; never the only one.
bool is_contact_segment(const HybridSystem& system, const Signature& signature, int s);

}  // namespace tchat

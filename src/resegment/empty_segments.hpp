/// Which segments of zero duration follow an impact that is born at grazing, and whether a signature fits an orbit.
#pragma once

#include <string>

#include "bvp/orbit.hpp"
#include "hybrid/hybrid_system.hpp"
#include "hybrid/index_vector.hpp"

namespace tchat {

/// The index vectors between the impact `after` in state x and a segment with field `next_field`, by the index jump
/// function: none when that field may follow directly or the plugin has no index jump function; otherwise the one
/// index vector that may follow, whose event holds in the state after the impact, and which `next_field` may follow.
/// Throws UserError when there is no such index vector or more than one: the signature has to be given.
Signature segments_after_impact(const HybridSystem& system, const IndexVector& after, const Eigen::VectorXd& x,
                                const ParameterVector& par, int next_field);

/// Throws UserError that names the segment when a terminal event does not hold at a segment's end or a jump does not
/// lead to the next segment's start, coarsely: what Newton is meant to repair passes.
void require_fit(const HybridSystem& system, const Signature& signature, const Orbit& x);

}  // namespace tchat

/// Jumps that change nothing: ends of segments that only cut an orbit, as on a Poincare section.
#pragma once

#include "model/hybrid_system.hpp"

namespace tchat {

/// Is jump k the identity map in every mode? Tried at two generic states.
bool is_identity_jump(const HybridSystem& system, int k);
/// Does the jump at the end of this segment leave the states of its mode as they are?
bool is_identity_jump(const HybridSystem& system, const IndexVector& segment);
/// The first jump that leaves the states of a field's mode as they are; 0 when the problem has none.
int first_identity_jump(const HybridSystem& system, int field);

}  // namespace tchat

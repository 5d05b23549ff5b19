/// Jumps that change nothing: ends of segments that only cut an orbit, as on a Poincare section.
#pragma once

#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// Is jump k the identity map? Tried at two generic states.
bool is_identity_jump(const HybridSystem& system, int k);

}  // namespace tchat

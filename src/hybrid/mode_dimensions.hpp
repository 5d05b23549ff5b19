/// Which modes of different dimension may follow each other.
#pragma once

#include <string>

#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// Why the field `next` cannot follow a segment, as a sentence with a cure; "" where it can. A jump leads to modes of
/// as many states as it sets; the identity leads to modes that have all states of the segment's own.
std::string mode_fault(const HybridSystem& system, const IndexVector& segment, int next);

}  // namespace tchat

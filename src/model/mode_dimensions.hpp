/// Which modes of different dimension may follow each other.
#pragma once

#include <Eigen/Core>
#include <string>

#include "model/hybrid_system.hpp"

namespace tchat {

/// Sets the entries of states that the mode of a field has not to zero.
void clear_absent(const HybridSystem& system, int field, Eigen::VectorXd& states);

/// Why the field `next` cannot follow a segment, as a sentence with a cure; "" where it can. After a jump the mode must
/// have exactly the states that the jump sets; after the identity it must have at least the states of the segment.
std::string mode_fault(const HybridSystem& system, const IndexVector& segment, int next);

}  // namespace tchat

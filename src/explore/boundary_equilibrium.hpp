/// Where an equilibrium meets an event surface (label BE), and the field on its other side is zero there as well.
#pragma once

#include "files/solution_file.hpp"
#include "model/hybrid_system.hpp"

namespace tchat {

/// Another field than `field` whose equilibrium the labelled state is too: in a continuous system the branch goes on
/// with it. 0 where there is none.
int other_field_at_rest(const HybridSystem& system, const LabelledSolution& solution, int field);

}  // namespace tchat

/// ISW = -1: from a period doubling to the doubled orbit (the signature repeated, 2 m segments), from a branch point to
/// the other branch.
///
/// The start is displaced along the full null vector of the boundary value problem, durations included, to the side
/// that the sign of DS picks, and corrected on the plane orthogonal to it.
#pragma once

#include "run/branch_setup.hpp"

namespace tchat {

/// Throws UserError when the start is neither a PD nor a BP label, ComputationError when the first step fails.
BranchSetup switch_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

}  // namespace tchat

/// Everything a branch needs before files are opened: the defining system, the follower, the first point.
///
/// The branch mode (ISW) decides: 1 continues the orbit of the start; 2 follows the two-parameter curve of the fold,
/// period doubling or torus bifurcation at the start; -1 switches at the start to the branch that bifurcates there.
#pragma once

#include <memory>

#include "run/branch_start.hpp"
#include "run/problem_types.hpp"

namespace tchat {

struct BranchSetup {
  RunSettings settings;  ///< really used: after a switch the signature of the new branch, and branch mode 1
  std::unique_ptr<DefiningSystem> defining;
  std::unique_ptr<PathFollower> follower;
  FirstPoint start;
  int curve_type =
      0;  ///< type number of the points that make a two-parameter curve: 5 fold, 7 period doubling, 8 torus
};

/// Throws UserError when the start is not of a kind that the branch mode can begin at, ComputationError when no first
/// point is found.
BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

}  // namespace tchat

/// Everything a branch needs before files are opened: the defining system, the follower, the first point.
///
/// The branch mode (ISW) decides: 1 continues the orbit of the start; 2 follows the two-parameter curve of the fold,
/// period doubling, torus bifurcation or branch point at the start, 3 one in three parameters; -1 switches at the start
/// to the branch that bifurcates there.
#pragma once

#include <memory>
#include <optional>

#include "bvp/defining_system.hpp"
#include "constants/run_settings.hpp"
#include "problem_type/problem_type.hpp"
#include "run/branch_start.hpp"

namespace tchat {

struct BranchSetup {
  const ProblemType* type = nullptr;  ///< really followed: after a switch that of the new branch
  RunSettings settings = {};          ///< likewise: after a switch its signature and branch mode
  std::unique_ptr<DefiningSystem> defining = nullptr;
  std::unique_ptr<PathFollower> follower = nullptr;
  FirstPoint start = {};
  /// What is written as the constants of the run where these are not its settings: of a torus those of one return.
  std::optional<RunSettings> constants = {};
};

/// Throws UserError when the start is not of a kind that the branch mode can begin at, ComputationError when no first
/// point is found.
BranchSetup set_up_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

}  // namespace tchat

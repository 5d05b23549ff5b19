/// From a branch point of equilibria to the other branch.
#include "problem_types/branch_switch_type.hpp"

namespace tchat::types {

const ProblemType& equilibrium_switch() {
  static const BranchSwitch type({.number = equilibrium.number,
                                  .branch_mode = branch_switch.branch_mode,
                                  .curve = 0,
                                  .family = "equilibria",
                                  .title = "the branch of equilibria that crosses at a BP label",
                                  .free_parameters = 1,
                                  .has_ring = false,
                                  .is_point = true,
                                  .switches_branch = true});
  return type;
}

}  // namespace tchat::types

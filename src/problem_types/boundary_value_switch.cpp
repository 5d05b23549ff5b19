/// From a branch point of boundary value problems to the other branch.
#include "problem_types/branch_switch_type.hpp"

namespace tchat::types {

const ProblemType& boundary_value_switch() {
  static const BranchSwitch type({.number = boundary_value.number,
                                  .branch_mode = branch_switch.branch_mode,
                                  .curve = 0,
                                  .family = "boundary value problems",
                                  .title = "the branch of boundary value problems that crosses at a BP label",
                                  .free_parameters = 0,
                                  .has_ring = false,
                                  .stability = StabilityMeaning::none,
                                  .switches_branch = true});
  return type;
}

}  // namespace tchat::types

/// From a branch point of a grazing curve to the other one.
#include "problem_types/branch_switch_type.hpp"

namespace tchat::types {

const ProblemType& grazing_branch_switch() {
  static const BranchSwitch type({.number = grazing_orbit.number,
                                  .branch_mode = branch_switch.branch_mode,
                                  .curve = 0,
                                  .family = "periodic orbits in grazing contact",
                                  .title = "the grazing curve that crosses at a BP label",
                                  .free_parameters = 2,
                                  .stability = StabilityMeaning::without_contact,
                                  .keeps_contact = true,
                                  .switches_branch = true});
  return type;
}

}  // namespace tchat::types

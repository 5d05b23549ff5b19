#include "problem_types/branch_switch_type.hpp"

#include <algorithm>
#include <array>

#include "bvp/defining_system.hpp"
#include "run/branch_switch.hpp"
#include "special_points/point_type.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

bool BranchSwitch::begins_at(int label_type) const {
  constexpr std::array types{PointType::period_doubling, PointType::branch_point, PointType::equilibrium_branch_point};
  return std::any_of(types.begin(), types.end(), [=](PointType type) { return label_type == static_cast<int>(type); });
}

std::unique_ptr<DefiningSystem> BranchSwitch::make_system(const HybridSystem& system, const RunSettings& settings,
                                                          std::vector<int> free_parameters) const {
  return followed().make_system(system, settings, std::move(free_parameters));
}

BranchSetup BranchSwitch::set_up(const HybridSystem& system, const RunSettings& settings,
                                 const SelectedStart& start) const {
  return switch_branch(system, settings, start);
}

std::vector<std::unique_ptr<TestFunction>> BranchSwitch::tests(const DefiningSystem& defining,
                                                               const RunSettings& settings) const {
  return followed().tests(defining, settings);
}

namespace types {

const ProblemType& branch_switch_type() {
  static const BranchSwitch type({.number = branch_switch.number,
                                  .branch_mode = branch_switch.branch_mode,
                                  .curve = 0,
                                  .family = "periodic orbits",
                                  .title = "the branch that bifurcates at a PD or BP label",
                                  .free_parameters = 1,
                                  .may_double = true,
                                  .switches_branch = true});
  return type;
}

}  // namespace types

}  // namespace tchat

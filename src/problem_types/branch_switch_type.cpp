/// From a period doubling or branch point to the branch of periodic orbits that bifurcates there
/// (run/branch_switch.hpp).
#include "run/branch_switch.hpp"

#include "bvp/defining_system.hpp"
#include "problem_type/problem_type.hpp"
#include "special_points/test_function.hpp"

namespace tchat::types {

namespace {

class BranchSwitch final : public ProblemType {
 public:
  BranchSwitch()
      : ProblemType({.number = branch_switch.number,
                     .branch_mode = branch_switch.branch_mode,
                     .curve = 0,
                     .family = "periodic orbits",
                     .title = "the branch that bifurcates at a PD or BP label",
                     .free_parameters = 1,
                     .may_double = true,
                     .switches_branch = true}) {}

  /// The branch that is switched to is one of periodic orbits.
  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return orbits().make_system(system, settings, std::move(free_parameters));
  }
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    return switch_branch(system, settings, start);
  }
  std::vector<std::unique_ptr<TestFunction>> tests(const DefiningSystem& defining, const RunSettings& settings,
                                                   const OrbitCondition* condition) const override {
    return orbits().tests(defining, settings, condition);
  }

 private:
  static const ProblemType& orbits() { return problem_type(periodic_orbit.number, periodic_orbit.branch_mode); }
};

}  // namespace

const ProblemType& branch_switch_type() {
  static const BranchSwitch type;
  return type;
}

}  // namespace tchat::types

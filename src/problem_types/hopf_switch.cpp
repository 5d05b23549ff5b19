/// From a Hopf bifurcation of equilibria to the periodic orbits (run/hopf_switch.hpp).
#include "run/hopf_switch.hpp"
#include "problem_types/branch_switch_type.hpp"
#include "special_points/point_type.hpp"

namespace tchat::types {

namespace {

class HopfSwitch final : public BranchSwitch {
 public:
  HopfSwitch()
      : BranchSwitch({.number = branch_switch.number,
                      .branch_mode = branch_switch.branch_mode,
                      .curve = 0,
                      .family = "periodic orbits",
                      .title = "the periodic orbits that are born at an HB label of equilibria",
                      .free_parameters = 1,
                      .switches_branch = true}) {}

  bool begins_at(int label_type) const override { return label_type == static_cast<int>(PointType::hopf); }
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    return begin_periodic_orbits(system, settings, start);
  }
};

}  // namespace

const ProblemType& hopf_switch() {
  static const HopfSwitch type;
  return type;
}

}  // namespace tchat::types

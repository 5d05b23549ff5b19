/// From a torus bifurcation of periodic orbits to the torus that is born there (run/torus_start.hpp).
#include "bvp/torus_system.hpp"
#include "problem_types/branch_switch_type.hpp"
#include "run/torus_start.hpp"
#include "special_points/point_type.hpp"

namespace tchat::types {

namespace {

class TorusSwitch final : public BranchSwitch {
 public:
  TorusSwitch()
      : BranchSwitch({.number = torus_birth.number,
                      .branch_mode = torus_birth.branch_mode,
                      .curve = 0,
                      .family = "invariant tori",
                      .title = "the torus that is born at a TR label of periodic orbits",
                      .free_parameters = 2,
                      .is_torus = true,
                      .switches_branch = true}) {}

  bool begins_at(int label_type) const override { return label_type == static_cast<int>(PointType::torus); }
  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    return begin_torus(system, settings, start);
  }
};

}  // namespace

const ProblemType& torus_switch() {
  static const TorusSwitch type;
  return type;
}

}  // namespace tchat::types

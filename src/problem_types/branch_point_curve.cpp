/// Branch points of periodic orbits that persist in two parameters, as the symmetry breaking of a symmetric system
/// does. Conditions and counts: bvp/critical_branch_point.hpp.
#include <fmt/format.h>

#include "bvp/critical_branch_point.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "constants/settings_type.hpp"
#include "problem_types/two_parameter_curve.hpp"
#include "run/branch_setup.hpp"
#include "special_points/curve_tests.hpp"
#include "start/start_selection.hpp"
#include "text/user_error.hpp"

namespace tchat::types {

namespace {

/// With the unfolding parameter among the free ones of the defining system, but not among those of the run.
class BranchPointCurve final : public TwoParameterCurve {
 public:
  BranchPointCurve()
      : TwoParameterCurve(PointType::branch_point, two_parameters,
                          "branch points that persist (symmetry breaking) in two parameters") {}

  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    free_parameters.push_back(unfolding_parameter);
    return std::make_unique<UnfoldedSystem>(
        std::make_unique<PeriodicOrbitSystem>(system, settings.signature(), std::move(free_parameters)));
  }

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalBranchPoint>(static_cast<const UnfoldedSystem&>(defining), start.start.orbit.shape);
  }

  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    SelectedStart unfolded = start;
    unfolded.start.orbit.par(unfolding_parameter - 1) = 0.0;
    if (std::optional<OrbitVector>& direction = unfolded.start.direction) {
      direction->globals.conservativeResize(direction->globals.size() + 1);
      direction->globals(direction->globals.size() - 1) = 0.0;
    }
    refuse_broken(system, settings, start);
    return TwoParameterCurve::set_up(system, settings, unfolded);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<ResonanceTest>(PointType::resonance_1));
  }

 private:
  /// A branch point that the second parameter breaks has no curve in two parameters.
  static void refuse_broken(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
    const std::vector<int> free = free_problem_parameters(settings);
    const PeriodicOrbitSystem plain(system, settings.signature(), free);
    const BranchPointBreaking breaking = branch_point_breaking(plain, start.start.orbit);
    if (!breaking.known || !breaking.by(1)) return;
    const std::string first_name = system.parameter_name(free[0]);
    const std::string second_name = system.parameter_name(free[1]);
    throw UserError(fmt::format(
        "{}: the branch point of label {} is one at this value of {} alone: the branches that cross there part when {} "
        "changes, so there is no curve of branch points in two parameters; with three there is: ISW = 3 and ICP = [{}, "
        "{}, ...] with a third parameter",
        start.source, start.label, second_name, second_name, first_name, second_name));
  }
};

}  // namespace

const ProblemType& branch_point_curve() {
  static const BranchPointCurve type;
  return type;
}

}  // namespace tchat::types

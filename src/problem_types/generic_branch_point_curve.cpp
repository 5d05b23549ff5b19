/// Generic branch points of periodic orbits, in three parameters. Conditions and counts: bvp/critical_branch_point.hpp.
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

class GenericCurve final : public TwoParameterCurve {
 public:
  GenericCurve()
      : TwoParameterCurve(PointType::branch_point, three_parameters, "generic branch points in three parameters") {}

  std::unique_ptr<OrbitCondition> make_condition(const DefiningSystem& defining,
                                                 const SelectedStart& start) const override {
    return std::make_unique<CriticalBranchPoint>(defining, start.start.orbit.shape);
  }

  BranchSetup set_up(const HybridSystem& system, const RunSettings& settings,
                     const SelectedStart& start) const override {
    refuse_persistent(system, settings, start);
    return TwoParameterCurve::set_up(system, settings, start);
  }

 protected:
  void add_codimension_two(TestList& tests) const override {
    tests.push_back(std::make_unique<ResonanceTest>(PointType::resonance_1));
  }

 private:
  /// Where neither further parameter breaks the branch point, these are surfaces in three.
  static void refuse_persistent(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
    const std::vector<int> free = free_problem_parameters(settings);
    const PeriodicOrbitSystem plain(system, settings.signature(), free);
    const Orbit& x = start.start.orbit;
    const BranchPointBreaking breaking = branch_point_breaking(plain, x);
    if (!breaking.known || breaking.by(1) || breaking.by(2)) return;
    throw UserError(
        fmt::format("{}: the branch point of label {} persists when {} or {} changes, as that of a symmetric system "
                    "does: such points "
                    "are surfaces in three parameters, and curves in two; use ISW = 2 with ICP = [{}, {}]",
                    start.source, start.label, system.parameter_name(free[1]), system.parameter_name(free[2]),
                    system.parameter_name(free[0]), system.parameter_name(free[1])));
  }
};

}  // namespace

const ProblemType& generic_branch_point_curve() {
  static const GenericCurve type;
  return type;
}

}  // namespace tchat::types

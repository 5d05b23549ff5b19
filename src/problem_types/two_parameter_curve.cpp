#include "problem_types/two_parameter_curve.hpp"

#include "bvp/periodic_orbit_system.hpp"
#include "constants/run_settings.hpp"

namespace tchat {

TwoParameterCurve::TwoParameterCurve(PointType curve, Mode mode, const char* title)
    : ProblemType({.number = periodic_orbit.number,
                   .branch_mode = mode.branch_mode,
                   .curve = static_cast<int>(curve),
                   .family = "periodic orbits",
                   .title = title,
                   .free_parameters = mode.free_parameters,
                   .stability = StabilityMeaning::critical}) {}

std::unique_ptr<DefiningSystem> TwoParameterCurve::make_system(const HybridSystem& system, const RunSettings& settings,
                                                               std::vector<int> free_parameters) const {
  return std::make_unique<PeriodicOrbitSystem>(system, settings.signature(), std::move(free_parameters));
}

TestList TwoParameterCurve::tests(const DefiningSystem& defining, const RunSettings& settings) const {
  TestList tests = contact_tests(defining, settings);
  add_codimension_two(tests);
  add_user_values(tests, defining.system(), settings);
  return tests;
}

}  // namespace tchat

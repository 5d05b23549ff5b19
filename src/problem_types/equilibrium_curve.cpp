#include "problem_types/equilibrium_curve.hpp"

#include "bvp/equilibrium_system.hpp"
#include "constants/run_settings.hpp"
#include "run/equilibrium_test_lists.hpp"

namespace tchat {

EquilibriumCurve::EquilibriumCurve(PointType curve, const char* title)
    : ProblemType({.number = equilibrium.number,
                   .branch_mode = 2,
                   .curve = static_cast<int>(curve),
                   .family = "equilibria",
                   .title = title,
                   .free_parameters = 2,
                   .has_ring = false,
                   .is_point = true,
                   .stability = StabilityMeaning::critical}) {}

std::unique_ptr<DefiningSystem> EquilibriumCurve::make_system(const HybridSystem& system, const RunSettings& settings,
                                                              std::vector<int> free_parameters) const {
  return std::make_unique<EquilibriumSystem>(system, settings.signature(), std::move(free_parameters));
}

TestList EquilibriumCurve::tests(const DefiningSystem& defining, const RunSettings& settings) const {
  TestList tests = boundary_equilibrium_tests(defining, settings);
  add_codimension_two(tests);
  add_user_values(tests, defining.system(), settings);
  return tests;
}

}  // namespace tchat

/// Equilibria in one parameter: the equations are those of bvp/equilibrium_system.hpp.
#include "bvp/equilibrium_system.hpp"
#include "constants/run_settings.hpp"
#include "problem_type/problem_type.hpp"
#include "run/equilibrium_test_lists.hpp"

namespace tchat::types {

namespace {

class Equilibria final : public ProblemType {
 public:
  Equilibria()
      : ProblemType({.number = equilibrium.number,
                     .branch_mode = equilibrium.branch_mode,
                     .curve = 0,
                     .family = "equilibria",
                     .title = "equilibria in one parameter",
                     .free_parameters = 1,
                     .has_ring = false,
                     .is_point = true}) {}

  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return std::make_unique<EquilibriumSystem>(system, settings.signature(), std::move(free_parameters));
  }

  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override {
    TestList tests = boundary_equilibrium_tests(defining, settings);
    add_equilibrium_bifurcations(tests, settings);
    add_user_values(tests, defining.system(), settings);
    return tests;
  }
};

}  // namespace

const ProblemType& equilibria() {
  static const Equilibria type;
  return type;
}

}  // namespace tchat::types

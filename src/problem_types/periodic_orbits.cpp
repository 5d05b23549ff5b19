/// Periodic orbits in one parameter: the equations are those of bvp/periodic_orbit_system.hpp (5.1-5.7).
#include "bvp/periodic_orbit_system.hpp"
#include "constants/run_settings.hpp"
#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"

namespace tchat::types {

namespace {

class PeriodicOrbits final : public ProblemType {
 public:
  PeriodicOrbits()
      : ProblemType({.number = periodic_orbit.number,
                     .branch_mode = periodic_orbit.branch_mode,
                     .curve = 0,
                     .family = "periodic orbits",
                     .title = "periodic orbits in one parameter",
                     .free_parameters = 1}) {}

  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return std::make_unique<PeriodicOrbitSystem>(system, settings.signature(), std::move(free_parameters));
  }

  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override {
    TestList tests = contact_tests(defining, settings);
    add_bifurcations(tests, defining, settings);
    add_user_values(tests, defining.system(), settings);
    return tests;
  }
};

}  // namespace

const ProblemType& periodic_orbits() {
  static const PeriodicOrbits type;
  return type;
}

}  // namespace tchat::types

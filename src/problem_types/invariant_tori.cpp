/// Invariant tori: the equations are those of bvp/torus_system.hpp (dissertation, 2.4, 3.3, 4.3). Two parameters are
/// free, rho may be one of them.
#include "bvp/torus_system.hpp"
#include "constants/settings_type.hpp"
#include "run/torus_problem.hpp"
#include "special_points/test_function.hpp"

namespace tchat::types {

namespace {

class InvariantTori final : public TorusProblem {
 public:
  InvariantTori()
      : TorusProblem({.number = invariant_torus.number,
                      .branch_mode = invariant_torus.branch_mode,
                      .curve = 0,
                      .family = "invariant tori",
                      .title = "invariant tori, rho and one parameter free, or two with rho fixed",
                      .free_parameters = 2,
                      .is_torus = true}) {}

  std::vector<std::unique_ptr<TestFunction>> tests(const DefiningSystem& defining,
                                                   const RunSettings& settings) const override {
    const auto& system = static_cast<const TorusSystem&>(defining);
    return torus_tests(system, settings, chosen_events(settings, system.segments_per_return()));
  }
};

}  // namespace

const ProblemType& invariant_tori() {
  static const InvariantTori type;
  return type;
}

}  // namespace tchat::types

/// Boundary value problems with conditions of the problem's own: the equations are those of
/// bvp/boundary_value_system.hpp (5.6).
#include "bvp/boundary_value_system.hpp"
#include "constants/settings_type.hpp"
#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"

namespace tchat::types {

namespace {

class BoundaryValues final : public ProblemType {
 public:
  BoundaryValues()
      : ProblemType({.number = boundary_value.number,
                     .branch_mode = boundary_value.branch_mode,
                     .curve = 0,
                     .family = "boundary value problems",
                     .title = "boundary value problems, NBC + NINT conditions of the problem's own",
                     .free_parameters = 0,
                     .has_ring = false,
                     .stability = StabilityMeaning::none}) {}

  int free_entries(const RunSettings& settings) const override {
    return settings.boundary_conditions + settings.integral_conditions - settings.dimension * segment_count(settings) +
           1 + static_cast<int>(settings.held.size());
  }

  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return std::make_unique<BoundaryValueSystem>(system, settings.signature(), std::move(free_parameters),
                                                 free_durations(settings));
  }

  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override {
    TestList tests;
    add_bifurcations(tests, defining, settings);
    add_user_values(tests, defining.system(), settings);
    return tests;
  }
};

}  // namespace

const ProblemType& boundary_values() {
  static const BoundaryValues type;
  return type;
}

}  // namespace tchat::types

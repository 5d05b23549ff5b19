/// The problem types of boundary value problems (IPS = 4), with conditions of the problem's own: the equations are
/// those of orbit/boundary_value_system.hpp (5.6).
#include "kinds/families.hpp"
#include "kinds/problem_types.hpp"
#include "orbit/boundary_value_system.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

std::unique_ptr<BoundaryValueSystem> chain(const HybridSystem& system, const RunSettings& settings,
                                           std::vector<int> free) {
  return std::make_unique<BoundaryValueSystem>(system, settings.signature(), std::move(free), free_durations(settings));
}

BranchCurve branch(const BoundaryValueSystem& system, const RunSettings&, const SelectedStart&) {
  return {nullptr, [&system](const RunSettings& settings) {
            TestList tests;
            add_bifurcations(tests, system, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

ProblemFacts boundary_value_facts(int branch_mode, const char* title) {
  return {.number = boundary_value.number,
          .branch_mode = branch_mode,
          .curve = 0,
          .family = boundary_value_family,
          .solutions = "boundary value problems",
          .title = title,
          .free_parameters = 0,
          .stability = StabilityMeaning::none,
          .switches_branch = branch_mode < 0,
          .starts_at = "a period doubling (PD) or a branch point (BP)",
          .start_example = "PD"};
}

}  // namespace

std::vector<const ProblemType*> boundary_value_types() {
  static const ProblemRow<BoundaryValueSystem> branches(
      boundary_value_facts(boundary_value.branch_mode,
                           "boundary value problems, NBC + NINT conditions of the problem's own"),
      {}, chain, branch);
  static const SwitchRow switches(
      boundary_value_facts(branch_switch.branch_mode,
                           "the branch of boundary value problems that crosses at a BP label"),
      branch_switch_labels(), switch_branch);
  return {&branches, &switches};
}

}  // namespace tchat

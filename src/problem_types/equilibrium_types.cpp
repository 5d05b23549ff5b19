/// The problem types of equilibria (IPS = 1): branches in one parameter (bvp/equilibrium_system.hpp), curves of folds
/// and Hopf bifurcations in two, and the switch at a branch point.
#include "bvp/equilibrium_fold.hpp"
#include "bvp/equilibrium_system.hpp"
#include "bvp/hopf_pair.hpp"
#include "families/families.hpp"
#include "problem_types/problem_types.hpp"
#include "run/branch_switch.hpp"
#include "run/equilibrium_test_lists.hpp"
#include "run/problem_row.hpp"
#include "special_points/equilibrium_curve_tests.hpp"

namespace tchat {

namespace {

std::unique_ptr<EquilibriumSystem> state(const HybridSystem& system, const RunSettings& settings,
                                         std::vector<int> free) {
  return std::make_unique<EquilibriumSystem>(system, settings.signature(), std::move(free));
}

BranchCurve branch(const EquilibriumSystem& system, const RunSettings&, const SelectedStart&) {
  return {nullptr, [&system](const RunSettings& settings) {
            TestList tests = boundary_equilibrium_tests(system, settings);
            add_equilibrium_bifurcations(tests, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

/// The curve of a condition with the points of codimension two on it.
template <class Condition>
BranchCurve curve_of(const EquilibriumSystem& system, std::unique_ptr<Condition> condition,
                     TestList (*codimension_two)(const Condition&)) {
  const Condition& kept = *condition;
  return {std::move(condition), [&system, &kept, codimension_two](const RunSettings& settings) {
            TestList tests = boundary_equilibrium_tests(system, settings);
            for (auto& test : codimension_two(kept)) tests.push_back(std::move(test));
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

BranchCurve fold(const EquilibriumSystem& system, const RunSettings&, const SelectedStart& start) {
  return curve_of(system, std::make_unique<EquilibriumFold>(system, start.start.orbit.shape), equilibrium_fold_tests);
}

BranchCurve hopf(const EquilibriumSystem& system, const RunSettings&, const SelectedStart& start) {
  return curve_of(system, std::make_unique<HopfPair>(system, start.start.orbit.shape), hopf_curve_tests);
}

ProblemFacts equilibrium_facts(int branch_mode, const char* title) {
  return {.number = equilibrium.number,
          .branch_mode = branch_mode,
          .curve = 0,
          .family = equilibrium_family,
          .solutions = "equilibria",
          .title = title,
          .free_parameters = 1,
          .switches_branch = branch_mode < 0};
}

ProblemFacts curve_facts(PointType type, const char* title) {
  ProblemFacts facts = equilibrium_facts(2, title);
  facts.curve = static_cast<int>(type);
  facts.free_parameters = 2;
  facts.in_two_parameters = true;
  facts.stability = StabilityMeaning::critical;
  return facts;
}

}  // namespace

std::vector<const ProblemType*> equilibrium_types() {
  using State = ProblemRow<EquilibriumSystem>;
  static const State branches(equilibrium_facts(equilibrium.branch_mode, "equilibria in one parameter"), {}, state,
                              branch);
  static const State folds(curve_facts(PointType::equilibrium_fold, "folds of equilibria in two parameters"),
                           {PointType::equilibrium_fold}, state, fold);
  static const State hopf_points(curve_facts(PointType::hopf, "Hopf bifurcations of equilibria in two parameters"),
                                 {PointType::hopf}, state, hopf);
  static const SwitchRow switches(
      equilibrium_facts(branch_switch.branch_mode, "the branch of equilibria that crosses at a BP label"),
      branch_switch_labels(), switch_branch);
  return {&branches, &folds, &hopf_points, &switches};
}

}  // namespace tchat

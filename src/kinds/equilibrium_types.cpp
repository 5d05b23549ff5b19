/// The problem types of equilibria (IPS = 1): branches in one parameter (orbit/equilibrium_system.hpp), curves of
/// folds, Hopf bifurcations and boundary equilibria in two, and the switch at a branch point.
#include <cmath>
#include <optional>

#include "kinds/families.hpp"
#include "kinds/problem_types.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/equilibrium_system.hpp"
#include "orbit/orbit.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "run/hopf_switch.hpp"
#include "run/solver_settings.hpp"
#include "stability/equilibrium_tests.hpp"

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

/// Two curves cross at a double Hopf point: MODE chooses one.
BranchCurve hopf(const EquilibriumSystem& system, const RunSettings& run, const SelectedStart& start) {
  std::optional<double> omega;
  if (start.type == static_cast<int>(PointType::double_hopf))
    omega = chosen_frequency(system, start.start.orbit, start, run.mode);
  return curve_of(system, std::make_unique<HopfPair>(system, start.start.orbit.shape, omega), hopf_curve_tests);
}

/// The event function that is zero at a start: that of a BE label, elsewhere the monitored one nearest to zero. A BE
/// label on such a curve (tens digit) is where another one vanishes as well. 0 where none is zero.
int boundary_event(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const double at_zero = std::max(1e-6, settings.tolerance_special);  // a located point is known to EPSS
  const bool is_label = start.kind.kind == UserPointKind::boundary_equilibrium;
  const bool is_on_curve = basic_type(start.type) != start.type;
  if (is_label && !is_on_curve) return start.kind.index;
  const Orbit& x = start.start.orbit;
  int nearest = 0;
  double least = at_zero;
  for (const int event : settings.segments.front().monitor) {
    if (is_label && event == start.kind.index) continue;
    const double scale = event_scale(system, x, event);  // 0 where h depends on parameters alone
    const double distance = std::abs(system.event(event, x.end(0), x.par.data())) / (scale > 0.0 ? scale : 1.0);
    if (distance <= least) nearest = event, least = distance;
  }
  return nearest;
}

bool is_on_boundary(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  return boundary_event(system, settings, start) != 0;
}

/// f_i(x, p) = 0 and h_j(x, p) = 0.
BranchCurve boundary(const EquilibriumSystem& system, const RunSettings& run, const SelectedStart& start) {
  const int event = boundary_event(system.system(), run, start);
  return {std::make_unique<EventCondition>(system, start.start.orbit.shape, 0, event, true),
          [&system, event](const RunSettings& settings) {
            TestList tests = boundary_equilibrium_tests(system, settings, event);
            add_boundary_bifurcations(tests, system, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
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
  ProblemFacts boundary_facts =
      curve_facts(PointType::ordinary, "boundary equilibria, where an event function is zero, in two parameters");
  boundary_facts.curve = -static_cast<int>(PointType::user);  // BE labels are UZ in files
  boundary_facts.stability = StabilityMeaning::without_contact;
  static const State boundaries(boundary_facts, {PointType::user, PointType::end, PointType::regular}, state, boundary,
                                nullptr, is_on_boundary);
  static const SwitchRow switches(
      equilibrium_facts(branch_switch.branch_mode, "the branch of equilibria that crosses at a BP label"),
      branch_switch_labels(), switch_branch);
  return {&branches, &folds, &hopf_points, &boundaries, &switches};
}

}  // namespace tchat

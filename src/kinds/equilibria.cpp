/// Equilibria: one state each, with eigenvalues instead of multipliers; the analysis of their branches and their
/// problem types.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/levels.hpp"
#include "continuation/orbit_trend.hpp"
#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/equilibrium_system.hpp"
#include "orbit/orbit.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "run/data_start.hpp"
#include "run/hopf_switch.hpp"
#include "run/solver_settings.hpp"
#include "stability/equilibrium_tests.hpp"

namespace tchat {

namespace {

class EquilibriumFamily final : public SolutionFamily {
 public:
  EquilibriumFamily()
      : SolutionFamily({.solution = "an equilibrium",
                        .signature = {.most_segments = 1,
                                      .why_most = "an equilibrium is one state of one vector field",
                                      .ends_in_events = false,
                                      .why_no_events = "nothing ends a segment; events to watch are in GCHGRZIND",
                                      .durations = "an equilibrium has no duration",
                                      .parameters = "an equilibrium has no duration",
                                      .example = "1",
                                      .has_contacts_to_choose = false},
                        .headings = {.maximum = "", .has_period = false, .has_mesh = false},
                        .summary = {.contact = "boundary equilibrium",
                                    .advice = "  tried: halving the step down to DSMIN, Newton with ITNW iterations, "
                                              "NWTN of them with a new Jacobian.\n"
                                              "  you might: lower DSMIN (0 goes to 1e-10 DSMAX) or DSMAX; raise ITNW, "
                                              "NWTN; loosen EPSL and EPSU if they\n"
                                              "  are near rounding.\n",
                                    .lost_advice = "  you might: lower DSMAX; EPSL and EPSU smaller than EPSS\n",
                                    .structural_advice = ""},
                        .doubles_mesh = false,
                        .has_return_map = false}) {}

  OrbitShape shape(const RunSettings& settings) const override { return OrbitShape::point(settings.dimension); }
  SelectedStart start_from_data(const std::string& path, const RunSettings& settings,
                                const HybridSystem& system) const override {
    return start_from_state(path, settings, system);
  }
  OrbitShape restart_shape(const RunSettings& settings, const LabelledSolution&, const std::string&) const override {
    return shape(settings);
  }

  std::string why_unverifiable(const RunSettings& settings) const override {
    return fmt::format(
        "these are equilibria (IPS = {}), with nothing to integrate; their eigenvalues are in the d-file",
        settings.problem_type);
  }
  OrbitCheck check(const HybridSystem&, const RunSettings&, const Orbit&, const std::vector<std::complex<double>>&,
                   double, const CriticalMultipliers&) const override {
    return {};
  }
  std::string why_not(Analysis analysis, const std::string&) const override {
    if (analysis == Analysis::resegmentation)
      return ": it has no signature that could change; `tchat run` restarts from it";
    return no_periodic_orbit;
  }
};

}  // namespace

const SolutionFamily& equilibrium_family() {
  static const EquilibriumFamily family;
  return family;
}

namespace {

class EquilibriumAnalysis final : public BranchAnalysis {
 public:
  explicit EquilibriumAnalysis(const EquilibriumSystem& system) : system_(system) {}

  const FamilyFacts& facts() const override { return equilibrium_family().facts(); }
  void find_multipliers(const CondensedSystem&, const Orbit& x, FloquetMultipliers& result) override {
    result = equilibrium_eigenvalues(system_, x);
  }
  std::string start_advice(const Orbit&) const override {
    return "There may be no equilibrium near the start with these parameters; a better start or a larger ITNW may "
           "help.";
  }

 private:
  const EquilibriumSystem& system_;
};

}  // namespace

std::unique_ptr<BranchAnalysis> EquilibriumSystem::make_analysis(const OrbitShape&) const {
  return std::make_unique<EquilibriumAnalysis>(*this);
}

// The problem types of equilibria (IPS = 1): branches in one parameter (orbit/equilibrium_system.hpp), curves of
// folds, Hopf bifurcations and boundary equilibria in two, and the switch at a branch point.

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
            add_turning_points(tests, system, settings);
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
  const double at_zero = std::max(level::located, settings.tolerance_special);  // a located point is known to EPSS
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
            add_turning_points(tests, system, settings);
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

/// Periodic orbits: rings of segments, and their problem types.
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "kinds/curve_starts.hpp"
#include "kinds/families.hpp"
#include "kinds/orbit_check.hpp"
#include "model/events.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "run/hopf_switch.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/curve_tests.hpp"
#include "stability/grazing_tests.hpp"

namespace tchat {

namespace {

class PeriodicOrbitFamily final : public SegmentFamily {
 public:
  PeriodicOrbitFamily()
      : SegmentFamily({.solution = "a periodic orbit",
                       .summary = {.contact = "grazing point",
                                   .advice = orbit_advice,
                                   .lost_advice = lost_orbit_advice,
                                   .structural_advice = mesh_advice}}) {}

  OrbitCheck check(const HybridSystem& system, const RunSettings& settings, const Orbit& x,
                   const std::vector<std::complex<double>>& stored, double tolerance,
                   const CriticalMultipliers& critical) const override {
    return check_orbit(system, settings, x, stored, tolerance, critical);
  }
  std::string why_not(Analysis, const std::string&) const override { return ""; }
};

}  // namespace

const SolutionFamily& periodic_orbit_family() {
  static const PeriodicOrbitFamily family;
  return family;
}

// The problem types of periodic orbits (IPS = 180): branches in one parameter (5.1-5.7), curves in two or three with
// one or two conditions more (5.11-5.22), and switches to other branches.

namespace {

/// The facts of a curve of `type` points with ISW = `branch_mode`, which is the number of free parameters.
ProblemFacts curve_facts(PointType type, int branch_mode, const char* title) {
  return {.number = periodic_orbit.number,
          .branch_mode = branch_mode,
          .curve = static_cast<int>(type),
          .family = periodic_orbit_family,
          .solutions = "periodic orbits",
          .title = title,
          .free_parameters = branch_mode,
          .in_two_parameters = true,
          .stability = StabilityMeaning::critical};
}

/// Their labels are EX or points of such a curve, which have no number in files.
ProblemFacts extremum_facts(int branch_mode) {
  ProblemFacts facts = curve_facts(PointType::ordinary, branch_mode, "extrema of ICP(1), a monitor");
  facts.stability = StabilityMeaning::orbit;
  facts.start_example = "EX";
  return facts;
}

/// EX is a UZ in files.
std::vector<PointType> extremum_labels() { return {PointType::user, PointType::end, PointType::regular}; }

ProblemFacts switch_facts(const char* title, bool may_double) {
  return {.number = branch_switch.number,
          .branch_mode = branch_switch.branch_mode,
          .curve = 0,
          .family = periodic_orbit_family,
          .solutions = "periodic orbits",
          .title = title,
          .free_parameters = 1,
          .may_double = may_double,
          .may_conserve = true,
          .switches_branch = true,
          .starts_at =
              "a period doubling (PD), a branch point (BP) or a Hopf bifurcation of equilibria (HB), in two "
              "parameters at GPD, R2, GH, ZH and HH",
          .start_example = "PD"};
}

/// Of the curve of `type` points that begins at a label of codimension two.
ProblemFacts beginning_facts(PointType type, int starts_from, const char* title) {
  ProblemFacts facts = curve_facts(type, orbit_curve.branch_mode, title);
  facts.branch_mode = branch_switch.branch_mode;
  facts.may_double = starts_from == periodic_orbit.number;
  facts.switches_branch = true;
  facts.starts_from = starts_from;
  return facts;
}

std::unique_ptr<PeriodicOrbitSystem> ring(const HybridSystem& system, const RunSettings& settings,
                                          std::vector<int> free) {
  if (!settings.conserved.empty())
    return std::make_unique<ConservativeOrbitSystem>(system, settings.signature(), std::move(free),
                                                     conserved_quantity(system, settings.conserved),
                                                     settings.conserved);
  return std::make_unique<PeriodicOrbitSystem>(system, settings.signature(), std::move(free));
}

/// With the unfolding parameter among the free ones of the defining system, but not among those of the run.
std::unique_ptr<UnfoldedSystem> unfolded(const HybridSystem& system, const RunSettings& settings,
                                         std::vector<int> free) {
  free.push_back(system.layout().unfolding(segment_count(settings)));
  return std::make_unique<UnfoldedSystem>(ring(system, settings, std::move(free)));
}

BranchCurve branch(const PeriodicOrbitSystem& system, const RunSettings& run, const SelectedStart&) {
  return {nullptr,
          [&system](const RunSettings& settings) {
            TestList tests = contact_tests(system, settings);
            add_bifurcations(tests, system, settings);
            add_user_values(tests, system.system(), settings);
            return tests;
          },
          gradient_remark(system.system(), run)};
}

/// Where a quantity is conserved multipliers come in pairs, and meet others than these.
void add_meetings(TestList& tests, const PeriodicOrbitSystem& system, TestList meetings) {
  if (system.conserved_quantities() > 0) return;
  std::move(meetings.begin(), meetings.end(), std::back_inserter(tests));
}

bool looks_for_cubic_terms(const PeriodicOrbitSystem& system, const RunSettings& run) {
  constexpr int where_exact = 1;
  return run.cubic_terms > (system.system().has_third() ? 0 : where_exact);
}

BranchCurve fold(const PeriodicOrbitSystem& system, const RunSettings&, const SelectedStart& start) {
  return curve_of(system, std::make_unique<CriticalMultiplier>(system, start.start.orbit.shape, 1),
                  [&system](TestList& tests, const CriticalMultiplier& condition) {
                    add_meetings(tests, system, fold_curve_meetings(system));
                    tests.push_back(cusp_test(condition, system));
                    tests.push_back(double_multiplier_test(PointType::resonance_1, condition));
                  });
}

BranchCurve period_doubling(const PeriodicOrbitSystem& system, const RunSettings& run, const SelectedStart& start) {
  return curve_of(
      system, std::make_unique<CriticalMultiplier>(system, start.start.orbit.shape, -1),
      [&system, cubic = looks_for_cubic_terms(system, run)](TestList& tests, const CriticalMultiplier& condition) {
        tests.push_back(double_multiplier_test(PointType::resonance_2, condition));
        add_meetings(tests, system, doubling_curve_meetings(system, cubic));
      });
}

BranchCurve torus(const PeriodicOrbitSystem& system, const RunSettings& run, const SelectedStart& start) {
  return curve_of(system, std::make_unique<CriticalPair>(system, start.start.orbit.shape, pair_at(system, start)),
                  [&system, cubic = looks_for_cubic_terms(system, run)](TestList& tests, const CriticalPair& pair) {
                    for (auto& test : torus_curve_tests(pair)) tests.push_back(std::move(test));
                    add_meetings(tests, system, torus_curve_meetings(system, pair, cubic));
                  });
}

BranchCurve fixed_angle(const PeriodicOrbitSystem& system, const RunSettings&, const SelectedStart& start) {
  return curve_of(system,
                  std::make_unique<CriticalPair>(system, start.start.orbit.shape, pair_at(system, start),
                                                 fixed_cosine(system, start)),
                  [](TestList&, const CriticalPair&) {});
}

template <class System>
BranchCurve branch_point(const System& system, const RunSettings&, const SelectedStart& start) {
  return curve_of(system, std::make_unique<CriticalBranchPoint>(system, start.start.orbit.shape),
                  [](TestList& tests, const CriticalBranchPoint& condition) {
                    tests.push_back(double_multiplier_test(PointType::resonance_1, condition));
                  });
}

/// A fold in the principal parameter means nothing here.
BranchCurve double_event(const PeriodicOrbitSystem& system, const RunSettings&, const SelectedStart& start) {
  return {double_event_condition(system, start), [&system](const RunSettings& settings) {
            TestList tests = contact_tests(system, settings);
            RunSettings without_folds = settings;
            without_folds.detect_folds = 0;
            add_bifurcations(tests, system, without_folds);
            add_user_values(tests, system.system(), settings);
            return tests;
          }};
}

bool is_no_extremum(const HybridSystem&, const RunSettings&, const SelectedStart& start) {
  return start.kind.kind != UserPointKind::extremum;
}

/// An equilibrium of a conservative system has families of orbits about it, whatever its label.
BranchSetup leave_branch(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start) {
  const bool starts_at_rest = start.from_solution && start.start.orbit.shape.stored_nodes() == 1;
  if (starts_at_rest && !settings.conserved.empty()) return begin_periodic_orbits(system, settings, start);
  return switch_branch(system, settings, start);
}

}  // namespace

std::vector<const ProblemType*> periodic_orbit_types() {
  using Ring = ProblemRow<PeriodicOrbitSystem>;
  static const Ring orbits({.number = periodic_orbit.number,
                            .branch_mode = periodic_orbit.branch_mode,
                            .curve = 0,
                            .family = periodic_orbit_family,
                            .solutions = "periodic orbits",
                            .title = "periodic orbits in one parameter",
                            .free_parameters = 1,
                            .may_conserve = true},
                           {}, ring, branch);
  static const Ring folds(curve_facts(PointType::fold, 2, "folds of periodic orbits in two parameters"),
                          {PointType::fold}, ring, fold);
  static const Ring doublings(curve_facts(PointType::period_doubling, 2, "period doublings in two parameters"),
                              {PointType::period_doubling}, ring, period_doubling);
  static const Ring tori(curve_facts(PointType::torus, 2, "torus bifurcations in two parameters"), {PointType::torus},
                         ring, torus);
  static const ProblemRow<UnfoldedSystem> persistent_branch_points(
      curve_facts(PointType::branch_point, 2, "branch points that persist (symmetry breaking) in two parameters"),
      {PointType::branch_point}, unfolded, branch_point<UnfoldedSystem>, start_persistent_branch_points);
  static const Ring extrema_2(extremum_facts(2), extremum_labels(), ring, extrema, check_extremum, starts_at_extremum);
  static const Ring extrema_3(extremum_facts(3), extremum_labels(), ring, extrema, check_extremum, starts_at_extremum);
  static const Ring extrema_4(extremum_facts(4), extremum_labels(), ring, extrema, check_extremum, starts_at_extremum);
  static const Ring extrema_5(extremum_facts(5), extremum_labels(), ring, extrema, check_extremum, starts_at_extremum);
  static const Ring extrema_6(extremum_facts(6), extremum_labels(), ring, extrema, check_extremum, starts_at_extremum);
  static const Ring angles(
      curve_facts(PointType::torus, 3, "torus bifurcations of the start's angle in three parameters"),
      {PointType::torus}, ring, fixed_angle);
  static const Ring branch_points(curve_facts(PointType::branch_point, 3, "generic branch points in three parameters"),
                                  {PointType::branch_point}, ring, branch_point<PeriodicOrbitSystem>,
                                  start_generic_branch_points);
  static const Ring double_events({.number = periodic_orbit.number,
                                   .branch_mode = orbit_curve.branch_mode,
                                   .curve = -static_cast<int>(PointType::user),  // GR labels are UZ in files
                                   .family = periodic_orbit_family,
                                   .solutions = "periodic orbits",
                                   .title = "two events at once, such as the onset of sliding, in two parameters",
                                   .free_parameters = 2,
                                   .in_two_parameters = true},
                                  {PointType::user}, ring, double_event, nullptr, is_no_extremum);
  static const SwitchRow switches(switch_facts("the branch that bifurcates at a PD or BP label", true),
                                  branch_switch_labels(), leave_branch);
  ProblemFacts births_at_hopf = switch_facts("the periodic orbits that are born at an HB label of equilibria", false);
  births_at_hopf.starts_from = equilibrium.number;
  static const SwitchRow births(births_at_hopf, {PointType::hopf}, begin_periodic_orbits);
  static const SwitchRow folds_of_doubled(
      beginning_facts(PointType::fold, periodic_orbit.number, "the folds of doubled orbits that begin at a GPD label"),
      {PointType::generalized_doubling}, begin_fold_curve);
  static const SwitchRow tori_of_doubled(
      beginning_facts(PointType::torus, periodic_orbit.number,
                      "the torus bifurcations of doubled orbits that begin at an R2 label"),
      {PointType::resonance_2}, begin_torus_curve);
  static const SwitchRow folds_of_born(
      beginning_facts(PointType::fold, equilibrium.number, "the folds of periodic orbits that begin at a GH label"),
      {PointType::generalized_hopf}, begin_fold_curve);
  static const SwitchRow tori_of_born(
      beginning_facts(PointType::torus, equilibrium.number,
                      "the torus bifurcations of periodic orbits that begin at a ZH or HH label"),
      {PointType::zero_hopf, PointType::double_hopf}, begin_torus_curve);
  return {&orbits,           &folds,           &doublings,     &tori,        &persistent_branch_points,
          &extrema_2,        &angles,          &branch_points, &extrema_3,   &extrema_4,
          &extrema_5,        &extrema_6,       &double_events, &switches,    &births,
          &folds_of_doubled, &tori_of_doubled, &folds_of_born, &tori_of_born};
}

// The problem types of periodic orbits in grazing contact (IPS = 150), in two parameters: the equations are those of
// orbit/periodic_orbit_system.hpp (5.8-5.10).

namespace {

/// On a grazing curve, contacts with the other monitored events; with the same event on segments that do not touch the
/// contact that the curve keeps.
void add_further_contacts(TestList& tests, const GrazingOrbitSystem& system, const RunSettings& settings) {
  const int kept = system.grazing_segment();
  const int event = system.signature()[static_cast<std::size_t>(kept)].event;
  for (int s = 0; s < system.segments(); ++s)
    for (const int other : settings.segments[static_cast<std::size_t>(s)].monitor)
      if (other != event || (s != kept && s != (kept + 1) % system.segments()))
        tests.push_back(std::make_unique<ContactTest>(system, s, other, settings.stop_at_grazing));
}

/// xi_n by GCIPSI, a*, branch points, multipliers +1 and -1 of the smooth orbit, impact velocities of the other
/// segments, further contacts, turns of the curve in its first parameter.
TestList grazing_tests(const GrazingOrbitSystem& system, const RunSettings& settings) {
  TestList tests;
  add_impact_velocities(tests, system, settings);
  add_further_contacts(tests, system, settings);
  add_section_tangencies(tests, system, settings, system.grazing_segment());
  const bool has_impact = !is_identity_jump(system.system(), settings.grazing_jump);  // else every xi_n is zero
  for (const int n : has_impact ? settings.test_functions : std::vector<int>{})
    tests.push_back(std::make_unique<XiTest>(system, settings.grazing_jump, n));
  tests.push_back(std::make_unique<AccelerationTest>(system, settings.grazing_jump));
  add_turning_points(tests, system, settings, PointType::fold);
  const int kind = std::abs(settings.detect_bifurcations);
  if (kind == 2 || kind == 3) tests.push_back(std::make_unique<BranchPointTest>(settings.detect_bifurcations < 0));
  if (kind == 2 || kind == 4)
    for (const int target : {1, -1}) tests.push_back(std::make_unique<SmoothMultiplierTest>(target));
  add_user_values(tests, system.system(), settings);
  return tests;
}

std::unique_ptr<GrazingOrbitSystem> grazing_ring(const HybridSystem& system, const RunSettings& settings,
                                                 std::vector<int> free) {
  return std::make_unique<GrazingOrbitSystem>(system, settings.signature(), std::move(free), marked_segment(settings));
}

BranchCurve grazing_curve(const GrazingOrbitSystem& system, const RunSettings&, const SelectedStart&) {
  return {nullptr, [&system](const RunSettings& settings) { return grazing_tests(system, settings); }};
}

ProblemFacts grazing_facts(int branch_mode, const char* title) {
  return {.number = grazing_orbit.number,
          .branch_mode = branch_mode,
          .curve = 0,
          .family = periodic_orbit_family,
          .solutions = "periodic orbits in grazing contact",
          .title = title,
          .free_parameters = 2,
          .in_two_parameters = true,
          .stability = StabilityMeaning::without_contact,
          .keeps_contact = true,
          .switches_branch = branch_mode < 0,
          .starts_at = "a period doubling (PD) or a branch point (BP)",
          .start_example = "PD"};
}

}  // namespace

std::vector<const ProblemType*> grazing_types() {
  static const ProblemRow<GrazingOrbitSystem> curves(
      grazing_facts(grazing_orbit.branch_mode, "periodic orbits in grazing contact, in two parameters"), {},
      grazing_ring, grazing_curve);
  static const SwitchRow switches(
      grazing_facts(branch_switch.branch_mode, "the grazing curve that crosses at a BP label"), branch_switch_labels(),
      switch_branch);
  return {&curves, &switches};
}

}  // namespace tchat

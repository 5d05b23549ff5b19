/// The problem types of periodic orbits in grazing contact (IPS = 150), in two parameters: the equations are those of
/// orbit/periodic_orbit_system.hpp (5.8-5.10).
#include <algorithm>
#include <cstdlib>

#include "kinds/families.hpp"
#include "kinds/problem_types.hpp"
#include "model/identity_jump.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "run/branch_setup.hpp"
#include "run/branch_switch.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/grazing_tests.hpp"

namespace tchat {

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

std::unique_ptr<TestFunction> turn(const GrazingOrbitSystem& system, const RunSettings& settings) {
  const std::vector<int>& free = system.free_parameters();
  const int first = free_problem_parameters(settings).front();
  return std::make_unique<GrazingTurnTest>(std::find(free.begin(), free.end(), first) - free.begin(),
                                           system.system().parameter_name(first), settings.detect_folds < 0);
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
  if (settings.detect_folds != 0) tests.push_back(turn(system, settings));
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

#include "run/test_selection.hpp"

#include <algorithm>
#include <cstdlib>

#include "setup/problem_setup.hpp"
#include "special_points/bifurcation_tests.hpp"
#include "special_points/contact_test.hpp"
#include "special_points/curve_tests.hpp"
#include "special_points/grazing_curve_tests.hpp"
#include "special_points/user_value_test.hpp"

namespace tchat {

namespace {

using Tests = std::vector<std::unique_ptr<TestFunction>>;

/// These come last: where something else vanishes too, it names the label.
void add_user_values(Tests& tests, const HybridSystem& system, const RunSettings& settings) {
  for (const UserValue& u : settings.user_values)
    tests.push_back(std::make_unique<UserValueTest>(u.parameter, u.value, u.stop, system.parameter_name(u.parameter)));
}

/// ILP and ISP: |ISP| = 2 all, 3 branch points only, 4 all but branch points; negative: stop at the first.
void add_bifurcations(Tests& tests, const DefiningSystem& system, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  const bool stop = settings.detect_bifurcations < 0;
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), system.free_parameters(),
                                               system.segments(), settings.detect_folds < 0));
  if (kind == 2 || kind == 3) tests.push_back(std::make_unique<BranchPointTest>(stop));
  if (kind == 2 || kind == 4) {
    tests.push_back(std::make_unique<PeriodDoublingTest>(stop));
    tests.push_back(std::make_unique<TorusTest>(stop));
  }
}

void add_impact_velocities(Tests& tests, const DefiningSystem& system, const RunSettings& settings) {
  for (int s = 0; s < system.segments(); ++s)
    if (!is_identity_jump(system.system(), system.signature()[static_cast<std::size_t>(s)].jump))
      tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, settings.stop_at_grazing));
}

/// Identity jumps: the section may become tangent to the orbit, and no orbit is cut by it beyond. What a grazing curve
/// keeps is not watched.
void add_section_tangencies(Tests& tests, const DefiningSystem& system, const RunSettings& settings) {
  const auto* grazing = dynamic_cast<const GrazingOrbitSystem*>(&system);
  for (int s = 0; s < system.segments(); ++s)
    if ((grazing == nullptr || s != grazing->grazing_segment()) &&
        is_identity_jump(system.system(), system.signature()[static_cast<std::size_t>(s)].jump))
      tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, settings.stop_at_grazing));
}

/// GCIPSI counts through the monitored events of all segments in order.
void add_contacts(Tests& tests, const DefiningSystem& system, const RunSettings& settings) {
  int k = 0;
  for (int s = 0; s < system.segments(); ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor)
      if (const auto& chosen = settings.test_functions; std::find(chosen.begin(), chosen.end(), ++k) != chosen.end())
        tests.push_back(std::make_unique<ContactTest>(system, s, event, settings.stop_at_grazing));
}

void add_codimension_two(Tests& tests, const CriticalMultiplier& condition, int curve_type) {
  const bool fold = curve_type == static_cast<int>(PointType::fold);
  if (fold) tests.push_back(std::make_unique<CuspTest>(condition));
  tests.push_back(std::make_unique<ResonanceTest>(condition, fold ? PointType::resonance_1 : PointType::resonance_2));
}

/// On a grazing curve, contacts with the other monitored events; with the same event on segments that do not touch the
/// contact that the curve keeps.
void add_further_contacts(Tests& tests, const GrazingOrbitSystem& system, const RunSettings& settings) {
  const int kept = system.grazing_segment();
  const int event = system.signature()[static_cast<std::size_t>(kept)].event;
  for (int s = 0; s < system.segments(); ++s)
    for (const int other : settings.segments[static_cast<std::size_t>(s)].monitor)
      if (other != event || (s != kept && s != (kept + 1) % system.segments()))
        tests.push_back(std::make_unique<ContactTest>(system, s, other, settings.stop_at_grazing));
}

/// On a grazing curve: xi_n by GCIPSI, a*, branch points, multipliers +1 and -1 of the smooth orbit, impact velocities
/// of the other segments, further contacts. A fold in the principal parameter means nothing there.
Tests tests_on_grazing_curve(const GrazingOrbitSystem& system, const RunSettings& settings) {
  Tests tests;
  add_impact_velocities(tests, system, settings);
  add_further_contacts(tests, system, settings);
  add_section_tangencies(tests, system, settings);
  for (const int n : settings.test_functions)
    tests.push_back(std::make_unique<XiTest>(system, settings.grazing_jump, n));
  tests.push_back(std::make_unique<AccelerationTest>(system, settings.grazing_jump));
  const int kind = std::abs(settings.detect_bifurcations);
  if (kind == 2 || kind == 3) tests.push_back(std::make_unique<BranchPointTest>(settings.detect_bifurcations < 0));
  if (kind == 2 || kind == 4)
    for (const int target : {1, -1}) tests.push_back(std::make_unique<SmoothMultiplierTest>(target));
  add_user_values(tests, system.system(), settings);
  return tests;
}

}  // namespace

std::vector<std::unique_ptr<TestFunction>> select_tests(const DefiningSystem& system, const RunSettings& settings,
                                                        OrbitCondition* condition, int curve_type) {
  if (const auto* grazing = dynamic_cast<const GrazingOrbitSystem*>(&system))
    return tests_on_grazing_curve(*grazing, settings);
  Tests tests;
  // Where an impact vanishes the contact that it brings does too: the label is to say the former, so it comes first.
  add_impact_velocities(tests, system, settings);
  add_contacts(tests, system, settings);
  add_section_tangencies(tests, system, settings);
  if (const auto* critical = dynamic_cast<const CriticalMultiplier*>(condition))
    add_codimension_two(tests, *critical, curve_type);
  else if (const auto* pair = dynamic_cast<const CriticalPair*>(condition))
    for (const PointType type :
         {PointType::resonance_1, PointType::resonance_2, PointType::resonance_3, PointType::resonance_4})
      tests.push_back(std::make_unique<AngleTest>(*pair, type));
  else
    add_bifurcations(tests, system, settings);
  add_user_values(tests, system.system(), settings);
  return tests;
}

}  // namespace tchat

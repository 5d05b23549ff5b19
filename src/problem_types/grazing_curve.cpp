/// Periodic orbits in grazing contact, in two parameters: the equations are those of bvp/grazing_orbit_system.hpp
/// (5.8-5.10).
#include <algorithm>
#include <cstdlib>

#include "bvp/grazing_orbit_system.hpp"
#include "constants/settings_type.hpp"
#include "hybrid/identity_jump.hpp"
#include "problem_type/problem_type.hpp"
#include "run/test_lists.hpp"
#include "special_points/bifurcation_tests.hpp"
#include "special_points/contact_test.hpp"
#include "special_points/grazing_curve_tests.hpp"

namespace tchat::types {

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

class GrazingCurve final : public ProblemType {
 public:
  GrazingCurve()
      : ProblemType({.number = grazing_orbit.number,
                     .branch_mode = grazing_orbit.branch_mode,
                     .curve = 0,
                     .family = "periodic orbits in grazing contact",
                     .title = "periodic orbits in grazing contact, in two parameters",
                     .free_parameters = 2,
                     .stability = StabilityMeaning::without_contact,
                     .keeps_contact = true}) {}

  std::unique_ptr<DefiningSystem> make_system(const HybridSystem& system, const RunSettings& settings,
                                              std::vector<int> free_parameters) const override {
    return std::make_unique<GrazingOrbitSystem>(system, settings.signature(), std::move(free_parameters),
                                                marked_segment(settings));
  }

  /// xi_n by GCIPSI, a*, branch points, multipliers +1 and -1 of the smooth orbit, impact velocities of the other
  /// segments, further contacts, turns of the curve in its first parameter.
  TestList tests(const DefiningSystem& defining, const RunSettings& settings) const override {
    const auto& system = static_cast<const GrazingOrbitSystem&>(defining);
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
};

}  // namespace

const ProblemType& grazing_curve() {
  static const GrazingCurve type;
  return type;
}

}  // namespace tchat::types

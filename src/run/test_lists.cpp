#include "run/test_lists.hpp"

#include <algorithm>
#include <cstdlib>

#include "model/identity_jump.hpp"
#include "plugin/named_parameters.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/contact_test.hpp"
#include "stability/sliding_bifurcation.hpp"
#include "stability/user_value_test.hpp"

namespace tchat {

namespace {

/// GCIPSI counts through the monitored events of all segments in order.
void add_contacts(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  int k = 0;
  for (int s = 0; s < system.segments(); ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor)
      if (const auto& chosen = settings.test_functions; std::find(chosen.begin(), chosen.end(), ++k) != chosen.end())
        tests.push_back(std::make_unique<ContactTest>(system, s, event, settings.stop_at_grazing));
}

/// Where a segment of one side of a sliding mode is followed by one of the other.
void add_sliding_onsets(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  const Signature& signature = system.signature();
  for (std::size_t s = 0; s < signature.size(); ++s)
    for (const tchat_sliding& mode : system.system().sliding_modes()) {
      const int from = signature[s].field, to = signature[(s + 1) % signature.size()].field;
      if ((from == mode.minus && to == mode.plus) || (from == mode.plus && to == mode.minus))
        tests.push_back(
            std::make_unique<SlidingOnsetTest>(system, static_cast<int>(s), mode, settings.stop_at_grazing));
    }
}

/// Does a parameter of the problem keep its value along the branch? Its user values are passed nowhere.
bool is_fixed(const RunSettings& settings, int parameter) {
  const std::vector<int> free = free_problem_parameters(settings);
  return is_parameter(settings, parameter) && std::find(free.begin(), free.end(), parameter) == free.end();
}

}  // namespace

void add_user_values(TestList& tests, const HybridSystem& system, const RunSettings& settings) {
  for (const UserValue& u : settings.user_values)
    if (!is_fixed(settings, u.parameter))
      tests.push_back(
          std::make_unique<UserValueTest>(u.parameter, u.value, u.stop, parameter_name(system, settings, u.parameter)));
}

void add_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  const bool stop = settings.detect_bifurcations < 0;
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), system.free_parameters(),
                                               system.layout(), system.segments(), settings.detect_folds < 0,
                                               PointType::fold, held_text(system.system(), settings)));
  if (kind == 2 || kind == 3) tests.push_back(std::make_unique<BranchPointTest>(stop));
  if ((kind == 2 || kind == 4) && has_multipliers(settings.problem_type)) {
    tests.push_back(std::make_unique<PeriodDoublingTest>(stop));
    // Where a function is conserved pairs stay on the unit circle until they meet.
    if (settings.conserved.empty()) tests.push_back(std::make_unique<TorusTest>(stop));
  }
}

void add_impact_velocities(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  for (int s = 0; s < system.segments(); ++s)
    if (system.has_event(s) && !is_identity_jump(system.system(), system.signature()[static_cast<std::size_t>(s)]))
      tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, settings.stop_at_grazing));
}

void add_section_tangencies(TestList& tests, const DefiningSystem& system, const RunSettings& settings, int except) {
  for (int s = 0; s < system.segments(); ++s)
    if (s != except && system.has_event(s) &&
        is_identity_jump(system.system(), system.signature()[static_cast<std::size_t>(s)]))
      tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, settings.stop_at_grazing));
}

TestList contact_tests(const DefiningSystem& system, const RunSettings& settings) {
  TestList tests;
  // Where an impact vanishes the contact that it brings does too: the label is to say the former, so it comes first.
  add_impact_velocities(tests, system, settings);
  add_contacts(tests, system, settings);
  add_section_tangencies(tests, system, settings, -1);
  add_sliding_onsets(tests, system, settings);
  return tests;
}

}  // namespace tchat

#include "run/torus_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "bvp/bordered_problem.hpp"
#include "bvp/torus_system.hpp"
#include "constants/settings_type.hpp"
#include "run/test_lists.hpp"
#include "run/torus_start.hpp"
#include "setup/run_monitors.hpp"
#include "special_points/bifurcation_tests.hpp"
#include "special_points/torus_contact.hpp"

namespace tchat {

std::unique_ptr<OrbitCondition> TorusProblem::torus_condition(const TorusSystem&, const OrbitShape&,
                                                              const RunSettings&) const {
  return nullptr;
}

/// Of the fewest orbits: how many there are the start tells (set_up).
std::unique_ptr<DefiningSystem> TorusProblem::make_system(const HybridSystem& system, const RunSettings& settings,
                                                          std::vector<int> free_parameters) const {
  constexpr int fewest_orbits = 3;
  return std::make_unique<TorusSystem>(system, settings.signature(), fewest_orbits, std::move(free_parameters));
}

BranchSetup TorusProblem::set_up(const HybridSystem& system, const RunSettings& settings,
                                 const SelectedStart& start) const {
  return continue_torus(*this, system, settings, start);
}

std::string TorusProblem::remark(const BranchSetup& setup, const Orbit& x) const {
  const auto& system = static_cast<const TorusSystem&>(*setup.defining);
  const double frequency = 2.0 * std::numbers::pi / mean_return_time(system, x);
  const double rho = TorusSystem::rotation(x);
  return fmt::format("torus: rho = {:.10g}, frequencies {:.10g} and {:.10g}, {} harmonics, the last {:.1e}", rho,
                     frequency, rho * frequency, (system.orbits() - 1) / 2, last_harmonics(system, x));
}

bool TorusProblem::outgrown(const BranchSetup& setup, const Orbit& x) const {
  return fitting_harmonics(*setup.constants, static_cast<const TorusSystem&>(*setup.defining), x).has_value();
}

BranchSetup TorusProblem::refined(const BranchSetup& setup, const PathPoint& last) const {
  const auto& system = static_cast<const TorusSystem&>(*setup.defining);
  return with_harmonics(setup, last, *fitting_harmonics(*setup.constants, system, last.orbit));
}

std::string TorusProblem::unresolved(const BranchSetup& setup, const Orbit& x) const {
  return rough_torus(*setup.constants, static_cast<const TorusSystem&>(*setup.defining), x);
}

std::vector<MonitoredEvent> chosen_events(const RunSettings& settings, int segments_per_return) {
  std::vector<MonitoredEvent> all;
  for (int s = 0; s < segments_per_return; ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor) all.push_back({s, event});
  if (settings.test_functions.empty()) return all;
  std::vector<MonitoredEvent> chosen;
  for (const int k : settings.test_functions)
    if (k >= 1 && static_cast<std::size_t>(k) <= all.size()) chosen.push_back(all[static_cast<std::size_t>(k) - 1]);
  return chosen;
}

TestList torus_tests(const TorusSystem& system, const RunSettings& settings,
                     const std::vector<MonitoredEvent>& events) {
  TestList tests;
  for (const MonitoredEvent& at : events)
    tests.push_back(std::make_unique<TorusContactTest>(system, at.segment, at.event, settings.stop_at_grazing));
  const std::vector<int>& free = system.free_parameters();
  if (std::find(free.begin(), free.end(), rotation_parameter) != free.end())
    for (const auto& [p, q] : {std::pair{0, 1}, {1, 1}, {1, 2}, {1, 3}, {2, 3}, {1, 4}, {3, 4}})
      tests.push_back(std::make_unique<StrongResonanceTest>(p, q));
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), free, system.segments(),
                                               settings.detect_folds < 0, PointType::fold,
                                               held_text(system.system(), settings)));
  add_user_values(tests, system.system(), settings);
  return tests;
}

}  // namespace tchat

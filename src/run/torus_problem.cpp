#include "run/torus_problem.hpp"
#include "run/solver_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "base/user_error.hpp"
#include "orbit/torus_system.hpp"
#include "plugin/named_parameters.hpp"
#include "run/run_monitors.hpp"
#include "run/test_lists.hpp"
#include "run/torus_start.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/torus_contact.hpp"
#include "stability/torus_contact_condition.hpp"

namespace tchat {

namespace {

/// Least values of the events, strong resonances where rho is free, the fold, user values.
TestList torus_tests(const TorusSystem& system, const RunSettings& settings,
                     const std::vector<MonitoredEvent>& events) {
  TestList tests;
  for (const MonitoredEvent& at : events)
    tests.push_back(std::make_unique<TorusContactTest>(system, at.segment, at.event, settings.stop_at_grazing));
  const std::vector<int>& free = system.free_parameters();
  if (std::find(free.begin(), free.end(), system.layout().rotation()) != free.end())
    for (const auto& [p, q] : {std::pair{0, 1}, {1, 1}, {1, 2}, {1, 3}, {2, 3}, {1, 4}, {3, 4}})
      tests.push_back(std::make_unique<StrongResonanceTest>(p, q));
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), free, system.layout(),
                                               system.segments(), settings.detect_folds < 0, PointType::fold,
                                               held_text(system.system(), settings)));
  add_user_values(tests, system.system(), settings);
  return tests;
}

/// A torus as its trigonometric polynomials: their number follows the last harmonics.
class TorusDiscretisation final : public Discretisation {
 public:
  TorusDiscretisation(const TorusSystem& system, RunSettings one_return)
      : system_(system), one_return_(std::move(one_return)) {}

  /// Rotation number, frequencies, harmonics.
  std::string remark(const Orbit& x) const override {
    const double frequency = 2.0 * std::numbers::pi / mean_return_time(system_, x);
    const double rho = TorusSystem::rotation(x);
    return fmt::format("torus: rho = {:.10g}, frequencies {:.10g} and {:.10g}, {} harmonics, the last {:.1e}", rho,
                       frequency, rho * frequency, (system_.orbits() - 1) / 2, last_harmonics(system_, x));
  }
  bool is_outgrown(const Orbit& x) const override { return fitting_harmonics(one_return_, system_, x).has_value(); }
  BranchSetup refined(const BranchSetup& setup, const PathPoint& last) const override {
    return with_harmonics(setup, system_, last, *fitting_harmonics(one_return_, system_, last.orbit));
  }
  std::string why_unresolved(const Orbit& x) const override { return rough_torus(one_return_, system_, x); }

 private:
  const TorusSystem& system_;
  RunSettings one_return_;
};

/// The inner product of pseudo-arclength, a mean over the orbits: steps mean the same for any number of them.
WeightedNorm mean_norm(const RunSettings& settings, int orbits) {
  Eigen::VectorXd states = state_weights(settings) / orbits;
  ParameterVector parameters(settings.layout);
  parameters.setOnes();
  for (const IndexedValue& w : settings.parameter_weights) parameters(w.index - 1) = w.value;
  parameters.durations(max_torus_segments) /= orbits;
  return {std::move(states), std::move(parameters)};
}

}  // namespace

BranchSetup TorusProblem::set_up(const HybridSystem& system, const RunSettings& settings,
                                 const SelectedStart& start) const {
  return continue_torus(*this, system, settings, start);
}

BranchSetup TorusProblem::prepare(const HybridSystem& system, const RunSettings& one_return,
                                  const SelectedStart& start) const {
  const Orbit& x = start.start.orbit;
  const int orbits = x.shape.segments / segment_count(one_return);
  const std::vector<int> free = free_problem_parameters(one_return);
  check_memory(x.shape, static_cast<int>(free.size()));
  auto equations = std::make_unique<TorusSystem>(system, one_return.signature(), orbits, free,
                                                 torus_winding(system, one_return.signature(), x));
  BranchSetup setup{this, settings_of_orbits(one_return, orbits)};
  setup.constants = one_return;
  BranchCurve curve = make_curve_(*equations, x.shape, one_return);
  setup.make_tests = [tests = std::move(curve.tests), settings = setup.settings] { return tests(settings); };
  setup.discretisation = std::make_shared<TorusDiscretisation>(*equations, one_return);
  setup.follower = std::make_unique<PathFollower>(
      *equations, x.shape, mean_norm(setup.settings, orbits), newton_settings(one_return),
      one_return.free_parameters.front(), std::move(curve.condition), branch_monitors(*equations, setup.settings, x));
  setup.defining = std::move(equations);
  return setup;
}

BranchCurve free_torus(const TorusSystem& system, const OrbitShape&, const RunSettings&) {
  return {nullptr, [&system](const RunSettings& settings) {
            return torus_tests(system, settings, chosen_events(settings, system.segments_per_return()));
          }};
}

BranchCurve touching_torus(const TorusSystem& system, const OrbitShape& shape, const RunSettings& one_return) {
  const auto events = chosen_events(one_return, segment_count(one_return));
  if (events.empty())
    throw UserError(
        "IPS = 152 follows tori that touch a monitored event function, and GCHGRZIND lists none: name it on "
        "the segment where it is touched, as in GCHGRZIND=[[1]]");
  const auto tests = [&system](const RunSettings& settings) {
    auto others = chosen_events(settings, system.segments_per_return());
    if (!others.empty()) others.erase(others.begin());
    return torus_tests(system, settings, others);
  };
  return {std::make_unique<TorusContactCondition>(system, shape, events.front().segment, events.front().event), tests};
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

}  // namespace tchat

#include "run/solver_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "base/messages.hpp"
#include "model/events.hpp"
#include "model/scales.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/curve_tests.hpp"
#include "stability/equilibrium_tests.hpp"
#include "stability/grazing_tests.hpp"
#include "stability/test_function.hpp"

namespace tchat {

std::shared_ptr<const Monitor> principal_monitor(const DefiningSystem& system, const RunSettings& settings) {
  const int k = settings.free_parameters.front();
  if (!is_monitor(settings, k)) return nullptr;
  return make_monitor(parse_monitor(system.system(), parameter_name(system.system(), settings, k), "ICP"), system);
}

BranchMonitors branch_monitors(const DefiningSystem& system, const RunSettings& settings, const Orbit& start) {
  const std::vector<MonitorName> names = monitor_names(system.system(), settings);
  const CollocationRule rule(start.shape.collocation);
  BranchMonitors monitors{MonitorSet(names, system), {}};
  for (const HeldValue& held : settings.held) {
    std::shared_ptr<const Monitor> monitor =
        is_monitor(settings, held.parameter)
            ? make_monitor(names[static_cast<std::size_t>(held.parameter - first_monitor(settings))], system)
            : make_duration_monitor(settings.layout.duration_segment(held.parameter));
    const double value = held.value ? *held.value : monitor->value(start, rule);
    monitors.held.push_back({std::move(monitor), value, parameter_name(system.system(), settings, held.parameter)});
  }
  return monitors;
}

namespace {

/// GCIPSI counts through the monitored events of all segments in order.
void add_contacts(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  int k = 0;
  for (int s = 0; s < system.segments(); ++s)
    for (const int event : settings.segments[static_cast<std::size_t>(s)].monitor)
      if (const auto& chosen = settings.test_functions; std::find(chosen.begin(), chosen.end(), ++k) != chosen.end())
        tests.push_back(std::make_unique<ContactTest>(system, s, event, settings.stop_at_grazing));
}

/// Is the branch a curve of orbits on which the impacts that segment s ends in, from 0, just cease to accumulate?
bool holds_margin(const DefiningSystem& system, const RunSettings& settings, int s) {
  const tchat_chatter* const chatter =
      system.system().chatter_with_limit(system.signature()[static_cast<std::size_t>(s)].jump);
  if (chatter == nullptr) return false;
  const std::vector<MonitorName> names = monitor_names(system.system(), settings);
  return std::any_of(settings.held.begin(), settings.held.end(), [&](const HeldValue& held) {
    if (!is_monitor(settings, held.parameter)) return false;
    const MonitorName& name = names[static_cast<std::size_t>(held.parameter - first_monitor(settings))];
    return name.kind == MonitorName::Kind::end && name.number == s + 1 && name.quantity.kind == Quantity::Kind::event &&
           name.quantity.index == chatter->margin;
  });
}

/// None where the problem does not say what follows, and where it is one thing on one side of a whole curve.
void add_rules(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  for (int s = 0; s < system.segments() && system.system().has_successors(); ++s)
    if (!holds_margin(system, settings, (s + 1) % system.segments()))
      tests.push_back(std::make_unique<RuleTest>(system, s, settings.stop_at_grazing));
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

void add_turning_points(TestList& tests, const DefiningSystem& system, const RunSettings& settings, PointType type) {
  const std::vector<int> free = free_problem_parameters(settings);
  const int principal = settings.free_parameters.front();
  const auto at = std::find(free.begin(), free.end(), principal);
  if (settings.detect_folds == 0 || free.size() < 2 || at == free.end()) return;
  tests.push_back(turning_test(at - free.begin(), parameter_name(system.system(), settings, principal), type,
                               settings.detect_folds < 0));
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
    for (const int target : {1, -1}) tests.push_back(std::make_unique<MultiplierPairTest>(target, stop));
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
  add_rules(tests, system, settings);
  return tests;
}

namespace {

void add_hopf(TestList& tests, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  if (kind == 2 || kind == 4) tests.push_back(std::make_unique<HopfTest>(settings.detect_bifurcations < 0));
}

}  // namespace

TestList boundary_equilibrium_tests(const DefiningSystem& system, const RunSettings& settings, int except) {
  TestList tests;
  for (const int event : settings.segments.front().monitor)
    if (event != except)
      tests.push_back(std::make_unique<BoundaryEquilibriumTest>(system, event, settings.stop_at_grazing));
  return tests;
}

void add_equilibrium_bifurcations(TestList& tests, const RunSettings& settings) {
  const int kind = std::abs(settings.detect_bifurcations);
  const bool stop = settings.detect_bifurcations < 0;
  if (settings.detect_folds != 0)
    tests.push_back(std::make_unique<FoldTest>(settings.free_parameters.front(), free_problem_parameters(settings),
                                               settings.layout, 1, settings.detect_folds < 0,
                                               PointType::equilibrium_fold));
  if (kind == 2 || kind == 3)
    tests.push_back(std::make_unique<BranchPointTest>(stop, PointType::equilibrium_branch_point));
  if (kind == 2) tests.push_back(std::make_unique<EigenvaluePairTest>(stop));
  add_hopf(tests, settings);
}

void add_boundary_bifurcations(TestList& tests, const DefiningSystem& system, const RunSettings& settings) {
  if (settings.detect_folds != 0) tests.push_back(zero_eigenvalue_test(system));
  add_hopf(tests, settings);
}

namespace {

/// Bytes that the system could still give; 0 when it does not say.
double available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  double kilobytes = 0.0;
  std::string unit;
  while (file >> key >> kilobytes) {
    std::getline(file, unit);
    if (key == "MemAvailable:") return 1024.0 * kilobytes;
  }
  return 0.0;
}

}  // namespace

Eigen::VectorXd state_weights(const RunSettings& settings) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(settings.dimension);
  for (const IndexedValue& w : settings.state_weights) weights(w.index - 1) = w.value;
  return weights;
}

WeightedNorm weighted_norm(const RunSettings& settings, const Orbit& start) {
  ParameterVector weights(settings.layout, segment_count(settings));
  weights.setOnes();
  weights.durations(segment_count(settings)) *= default_weight(std::abs(start.period()));
  for (const IndexedValue& w : settings.parameter_weights) weights(w.index - 1) = w.value;
  return {state_weights(settings), std::move(weights)};
}

NewtonSettings newton_settings(const RunSettings& settings) {
  return {settings.max_newton, settings.full_newton, settings.tolerance_parameters, settings.tolerance_states,
          settings.threads};
}

ContinuationSettings continuation_settings(const RunSettings& settings) {
  ContinuationSettings c;
  c.step = {settings.step, settings.step_min, settings.step_max, settings.adapt_step_every, settings.max_newton};
  c.max_points = settings.max_points;
  c.principal = settings.free_parameters.front();
  c.parameter_min = settings.parameter_min;
  c.parameter_max = settings.parameter_max;
  c.measure_min = settings.measure_min;
  c.measure_max = settings.measure_max;
  c.measure = settings.measure;
  c.state_weights = state_weights(settings);
  c.print_every = settings.print_every;
  c.adapt_mesh_every = settings.adapt_mesh_every;
  c.multipliers = settings.detect_bifurcations != 0 && has_multipliers(settings.problem_type);
  c.stop_when_closed = settings.stop_when_closed;
  c.negative_durations = !settings.stop_at_grazing;
  const FamilyFacts& family = family_of(settings).facts();
  const bool has_stability = c.multipliers && family.reports_stability && !keeps_contact(settings.problem_type) &&
                             !has_critical_multiplier(settings.problem_type, settings.branch_mode);
  c.reports_stability = has_stability && std::abs(settings.detect_bifurcations) == 2 && settings.detect_folds != 0;
  c.error_bound = family.doubles_mesh ? settings.error_bound : 0.0;
  c.location_tolerance = settings.tolerance_special;
  c.max_location = settings.max_location_iterations;
  for (const SegmentSettings& segment : settings.segments) c.monitored.push_back(segment.monitor);
  return c;
}

void check_memory(const OrbitShape& shape, int free_parameters) {
  const double n = shape.dimension;
  const double c = shape.collocation;
  const double interval =
      (c * n + 2) * ((c + 1) * n + 5 + free_parameters) + (2 * n + 2) * (3 * n + 5 + free_parameters);
  const double vectors = 25 * n * c;  // orbits, tangents and right-hand sides
  const double needed = 8.0 * shape.segments * shape.intervals * (interval + vectors);
  const double available = available_memory();
  if (available > 0.0 && needed > available)
    throw UserError(fmt::format(
        "{} segments of {} states with NTST = {} and NCOL = {} need about {:.1f} GB of memory, "
        "{:.1f} GB are free; use a smaller NTST or NCOL",
        shape.segments, shape.dimension, shape.intervals, shape.collocation, needed / 1e9, available / 1e9));
}

}  // namespace tchat

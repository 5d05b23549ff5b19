#include "run/solver_settings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <string>

#include "base/user_error.hpp"
#include "settings/family.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

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

WeightedNorm weighted_norm(const RunSettings& settings) {
  ParameterVector weights(settings.layout, segment_count(settings));
  weights.setOnes();
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

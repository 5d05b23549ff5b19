#include "run/problem_setup.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>

#include "constants/user_error.hpp"

namespace tchat {

namespace {

void check_index(const HybridSystem& system, FunctionKind kind, int index, const char* keyword, const char* what, int s,
                 const std::string& constants_name) {
  if (index >= 1 && index <= system.count(kind)) return;
  throw UserError(fmt::format("{}: {} of segment {} is {}, but problem {} has {} {}; allowed: 1..{}", constants_name,
                              keyword, s, index, system.name(), system.count(kind), what, system.count(kind)));
}

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

std::vector<std::string> check_settings_against(const HybridSystem& system, const RunSettings& settings,
                                                const std::string& constants_name) {
  if (settings.dimension != system.dimension())
    throw UserError(fmt::format("{}: NDIM is {}, but problem {} has {} states; set NDIM = {}", constants_name,
                                settings.dimension, system.name(), system.dimension(), system.dimension()));
  std::vector<std::string> warnings;
  int s = 0;
  for (const SegmentSettings& segment : settings.segments) {
    ++s;
    check_index(system, FunctionKind::field, segment.index.field, "GCFIND", "vector fields", s, constants_name);
    check_index(system, FunctionKind::event, segment.index.event, "GCHIND", "event functions", s, constants_name);
    check_index(system, FunctionKind::jump, segment.index.jump, "GCGIND", "jump functions", s, constants_name);
    for (const int event : segment.monitor)
      check_index(system, FunctionKind::event, event, "GCHGRZIND", "event functions", s, constants_name);
    const bool identity = is_identity_jump(system, segment.index.jump);
    if ((segment.type == 0 && !identity) || (segment.type == 1 && identity))
      warnings.push_back(
          fmt::format("{}: GCSEGTYP of segment {} is {} ({} jump), but jump {} ({}) is {}the identity; "
                      "the jump decides",
                      constants_name, s, segment.type, segment.type == 0 ? "identity" : "another", segment.index.jump,
                      system.function_name(FunctionKind::jump, segment.index.jump), identity ? "" : "not "));
  }
  const int m = static_cast<int>(settings.segments.size());
  for (const int k : settings.free_parameters)
    if (k > system.parameters() && !is_duration(k, m))
      warnings.push_back(fmt::format("{}: ICP lists PAR({}), but problem {} has {} parameters", constants_name, k,
                                     system.name(), system.parameters()));
  return warnings;
}

int parameter_index(const HybridSystem& system, const std::string& name, const std::string& where) {
  int k = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), k);
  if (error == std::errc{} && end == name.data() + name.size()) {
    if (k >= 1 && k <= parameter_length) return k;
  } else if (const int named = system.parameter_index(name); named > 0) {
    return named;
  }
  std::string list;
  for (int i = 1; i <= system.parameters(); ++i)
    list += fmt::format("{}{}", i > 1 ? ", " : "", system.parameter_name(i));
  throw UserError(
      fmt::format("{}: PAR({}) is no parameter of problem {}; it has {}, and PAR(61), ... are the durations", where,
                  name, system.name(), list.empty() ? "none" : list));
}

Eigen::VectorXd state_weights(const RunSettings& settings) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(settings.dimension);
  for (const IndexedValue& w : settings.state_weights) weights(w.index - 1) = w.value;
  return weights;
}

WeightedNorm weighted_norm(const RunSettings& settings) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(parameter_length);
  for (const IndexedValue& w : settings.parameter_weights) weights(w.index - 1) = w.value;
  return {state_weights(settings), weights};
}

NewtonSettings newton_settings(const RunSettings& settings) {
  return {settings.max_newton, settings.full_newton, settings.tolerance_parameters, settings.tolerance_states};
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
  c.multipliers = settings.detect_bifurcations != 0;
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

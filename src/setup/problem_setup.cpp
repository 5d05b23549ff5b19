#include "setup/problem_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "bvp/quantity.hpp"
#include "constants/constants_file.hpp"
#include "constants/settings_type.hpp"
#include "hybrid/mode_dimensions.hpp"
#include "problem_type/family.hpp"
#include "problem_type/problem_type.hpp"
#include "setup/run_monitors.hpp"
#include "text/number.hpp"
#include "text/user_error.hpp"

namespace tchat {

namespace {

void check_index(const HybridSystem& system, FunctionKind kind, int index, const char* keyword, const char* what, int s,
                 const SettingsSource& source) {
  if (index >= 1 && index <= system.count(kind)) return;
  const char* const zero = kind == FunctionKind::event  ? "0 (an orbit without a section)"
                           : kind == FunctionKind::jump ? "0 (the identity)"
                                                        : "";
  if (system.count(kind) == 0)
    throw UserError(fmt::format("{}: {} of segment {} is {}, but problem {} has no {}; allowed: {}", source.of(keyword),
                                keyword, s, index, system.name(), what, zero));
  throw UserError(fmt::format("{}: {} of segment {} is {}, but problem {} has {} {}; allowed: 1..{}",
                              source.of(keyword), keyword, s, index, system.name(), system.count(kind), what,
                              system.count(kind)));
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

/// May the problem read entries of PAR beyond its parameters? The Fortran interface, which alone knows durations, need
/// not say how many parameters it has; entries that are set for output stand before the durations too.
bool has_further_parameters(const HybridSystem& system) {
  return system.table().initial_durations != nullptr || system.table().output_parameters != nullptr;
}

bool is_own_parameter(const HybridSystem& system, int k) {
  return k >= 1 &&
         (k <= system.parameters() || k >= system.layout().first_duration() || has_further_parameters(system));
}

bool is_known(const HybridSystem& system, int k) {
  return k == system.layout().rotation() || is_own_parameter(system, k);
}

/// In a ring, modes have the states that jumps set.
void check_modes(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source) {
  const Signature signature = settings.signature();
  for (std::size_t s = 0; s < signature.size(); ++s)
    if (const std::string fault = mode_fault(system, signature[s], signature[(s + 1) % signature.size()].field);
        !fault.empty())
      throw UserError(fmt::format("{}: segment {}: {}", source.of("GCGIND"), s + 1, fault));
}

/// The conditions are the problem's; the constants say how many there are, for the count of free parameters.
void check_conditions(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source) {
  if (system.boundary_conditions() == 0)
    throw UserError(fmt::format(
        "IPS = {} needs boundary conditions, and problem {} has none; write them as its member `boundary` (Fortran: "
        "GCBCND)",
        settings.problem_type, system.name()));
  const auto check = [&](const char* keyword, int given, int own, const char* what) {
    if (given == own) return;
    throw UserError(fmt::format("{}: {} is {}, but problem {} has {} {} conditions; set {} = {}", source.of(keyword),
                                keyword, given, system.name(), own, what, keyword, own));
  };
  check("NBC", settings.boundary_conditions, system.boundary_conditions(), "boundary");
  check("NINT", settings.integral_conditions, system.integral_conditions(), "integral");
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    if (!settings.segments[s].monitor.empty())
      throw UserError(
          fmt::format("{}: GCHGRZIND lists events on segment {}, and none are watched with IPS = {}; give "
                      "empty lists",
                      source.of("GCHGRZIND"), s + 1, settings.problem_type));
}

/// The jump that contact would bring, which xi_n is made of on a grazing curve.
void check_contact_jump(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source,
                        std::vector<std::string>& warnings) {
  const int jumps = system.count(FunctionKind::jump);
  const bool is_default = settings.grazing_jump == RunSettings{}.grazing_jump;
  if (jumps == 0 && keeps_contact(settings.problem_type))
    throw UserError(fmt::format(
        "{}: IPS = {} needs the jump that contact would bring, but problem {} has no jump functions; add one "
        "to the problem (the identity where contact brings none)",
        source.of("GRJUMP"), settings.problem_type, system.name()));
  if (settings.grazing_jump > jumps && (keeps_contact(settings.problem_type) || !is_default))
    throw UserError(fmt::format("{}: GRJUMP is {}, but problem {} has {} jump functions; allowed: 1..{}",
                                source.of("GRJUMP"), settings.grazing_jump, system.name(), jumps, jumps));
  if (keeps_contact(settings.problem_type) && !settings.test_functions.empty() &&
      is_identity_jump(system, settings.grazing_jump))
    warnings.push_back(fmt::format(
        "{}: GRJUMP = {} ({}) is the identity, for which there are no xi_n: GCIPSI has no effect; if contact is an "
        "impact, GRJUMP is to name its jump",
        source.of("GRJUMP"), settings.grazing_jump, system.function_name(FunctionKind::jump, settings.grazing_jump)));
}

/// The rotation number is a parameter of tori alone.
void check_rotation(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source,
                    const std::vector<int>& free) {
  const bool is_free = std::find(free.begin(), free.end(), system.layout().rotation()) != free.end();
  if (is_free && !family_of(settings).facts().has_rotation && !has_further_parameters(system))
    throw UserError(fmt::format("{}: ICP: {} is the rotation number of a torus, a parameter with IPS = {} alone",
                                source.of("ICP"), rotation_name, invariant_torus.number));
}

/// PAR(name) = v and UZR beyond the problem's parameters would do nothing, and so would the run's free parameter: they
/// are refused. Further entries of ICP are mere columns of the output and weights are harmless: a warning.
void check_parameters(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source,
                      std::vector<std::string>& warnings) {
  for (const RunSettings::ParameterValue& value : settings.parameter_values)
    parameter_index(system, value.name, "command line");
  const auto no_parameter = [&](const char* keyword, int k) {
    return fmt::format("{}: {}: PAR({}) is no parameter of problem {}; it has {}", source.of(keyword), keyword, k,
                       system.name(), parameter_list(system));
  };
  if (!settings.conserved.empty()) conserved_quantity(system, settings.conserved);
  const std::vector<int> free = free_problem_parameters(settings);
  if (free.empty() && !settings.conserved.empty() && is_parameter(settings, settings.free_parameters.front()))
    throw UserError(fmt::format(
        "{}: ICP(1) is {}, but CONSERVED = {} leaves no parameter of the problem free: name what changes along the "
        "family, start({}), period or another monitor, or a duration; with HOLD of one of them a parameter is "
        "free",
        source.of("ICP"), system.parameter_name(settings.free_parameters.front()), settings.conserved,
        settings.conserved));
  check_rotation(system, settings, source, free);
  const auto is_parameter_here = [&](int k) {
    const bool is_rotation = k == system.layout().rotation() && !is_duration(settings, k);
    if (is_rotation && family_of(settings).facts().has_rotation) return true;
    return is_own_parameter(system, k) && !(is_rotation && k >= system.layout().first_duration());
  };
  for (const int k : settings.free_parameters) {
    if (is_parameter_here(k)) continue;
    if (std::find(free.begin(), free.end(), k) != free.end()) throw UserError(no_parameter("ICP", k));
    warnings.push_back(no_parameter("ICP", k));
  }
  for (const UserValue& value : settings.user_values)
    if (!is_monitor(settings, value.parameter) && !is_parameter_here(value.parameter))
      throw UserError(no_parameter("UZR", value.parameter));
  for (const BoundedValue& bounded : settings.bounds)
    if (!is_monitor(settings, bounded.parameter) && !is_parameter_here(bounded.parameter))
      throw UserError(no_parameter("BOUNDS", bounded.parameter));
  for (const IndexedValue& weight : settings.parameter_weights)
    if (is_monitor(settings, weight.index))
      warnings.push_back(fmt::format("{}: THL: {} has no weight of its own; states, durations and parameters have",
                                     source.of("THL"), parameter_name(system, settings, weight.index)));
    else if (!is_parameter_here(weight.index))
      warnings.push_back(no_parameter("THL", weight.index));
}

}  // namespace

std::string SettingsSource::of(std::string_view keyword) const {
  return is_overridden(overrides, keyword) ? "command line" : file;
}

std::vector<std::string> check_settings_against(const HybridSystem& system, const RunSettings& settings,
                                                const SettingsSource& source) {
  if (settings.dimension != system.dimension())
    throw UserError(fmt::format("{}: NDIM is {}, but problem {} has {} states; set NDIM = {}", source.of("NDIM"),
                                settings.dimension, system.name(), system.dimension(), system.dimension()));
  std::vector<std::string> warnings;
  const SignatureRules& rules = signature_rules(settings);
  if (rules.counts_conditions) check_conditions(system, settings, source);
  int s = 0;
  for (const SegmentSettings& segment : settings.segments) {
    ++s;
    check_index(system, FunctionKind::field, segment.index.field, "GCFIND", "vector fields", s, source);
    for (const int event : segment.monitor)
      check_index(system, FunctionKind::event, event, "GCHGRZIND", "event functions", s, source);
    if (!rules.ends_in_events) continue;
    if (segment.index.event != no_function)
      check_index(system, FunctionKind::event, segment.index.event, "GCHIND", "event functions", s, source);
    if (segment.index.jump != no_function)
      check_index(system, FunctionKind::jump, segment.index.jump, "GCGIND", "jump functions", s, source);
    if (segment.index.jump == no_function) continue;
    const bool identity = is_identity_jump(system, segment.index);
    if ((segment.type == 0 && !identity) || (segment.type == 1 && identity))
      warnings.push_back(fmt::format(
          "{}: GCSEGTYP of segment {} is {} ({} jump), but jump {} ({}) is {}the identity; "
          "the jump decides",
          source.of("GCSEGTYP"), s, segment.type, segment.type == 0 ? "identity" : "another", segment.index.jump,
          system.function_name(FunctionKind::jump, segment.index.jump), identity ? "" : "not "));
  }
  if (rules.ends_in_events) check_modes(system, settings, source);
  check_contact_jump(system, settings, source, warnings);
  check_monitors(system, settings, source);
  check_parameters(system, settings, source, warnings);
  return warnings;
}

std::string parameter_list(const HybridSystem& system) {
  constexpr int most = 60, first = 20;  // of more, the first and the last
  std::string names;
  for (int i = 1; i <= system.parameters(); ++i)
    if (system.parameters() <= most || i <= first || i == system.parameters())
      names += fmt::format("{}{}", i > 1 ? ", " : "", system.parameter_name(i));
    else if (i == first + 1)
      names += ", ...";
  if (names.empty()) return "none";
  return system.parameters() == 1 ? "PAR(1): " + names
                                  : fmt::format("PAR(1) to PAR({}): {}", system.parameters(), names);
}

int parameter_index(const HybridSystem& system, const std::string& name, const std::string& where) {
  if (const std::optional<int> k = parse_integer(name)) {
    if (is_known(system, *k)) return *k;
  } else if (const int named = system.parameter_index(name); named > 0) {
    return named;
  }
  throw UserError(fmt::format("{}: PAR({}) is no parameter of problem {}; it has {}; PAR({}), ... are the durations",
                              where, name, system.name(), parameter_list(system), system.layout().first_duration()));
}

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

#include "plugin/problem_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "model/identity_jump.hpp"
#include "model/mode_dimensions.hpp"
#include "orbit/quantity.hpp"
#include "plugin/named_parameters.hpp"
#include "settings/constants_file.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

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

/// In a ring, modes have the states that jumps set.
void check_modes(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source) {
  const Signature signature = settings.signature();
  for (std::size_t s = 0; s < signature.size(); ++s)
    if (const std::string fault = mode_fault(system, signature[s], signature[(s + 1) % signature.size()].field);
        !fault.empty())
      throw UserError(fmt::format("{}: segment {}: {}", source.of("GCGIND"), s + 1, fault));
}

/// Those of segments that the orbit has, and what may be held or be the principal parameter.
void check_monitor(const RunSettings& settings, int index, const MonitorName& monitor, const SettingsSource& source) {
  const auto refuse = [&](const char* keyword, const std::string& why) {
    throw UserError(fmt::format("{}: {}: {}", source.of(keyword),
                                settings.monitors[static_cast<std::size_t>(index - first_monitor(settings))], why));
  };
  const bool has_multipliers = family_of(settings).facts().has_return_map;
  const bool of_segment = monitor.kind != MonitorName::Kind::multiplier && monitor.number > 0;
  if (of_segment && monitor.number > segment_count(settings))
    refuse("ICP",
           fmt::format("the orbit has {} segment{}", segment_count(settings), segment_count(settings) == 1 ? "" : "s"));
  if (monitor.kind == MonitorName::Kind::velocity &&
      settings.segments[static_cast<std::size_t>(monitor.number - 1)].index.event == no_function)
    refuse("ICP", "no event function ends that segment; end(X, S) is the value of any function there");
  if (monitor.kind != MonitorName::Kind::multiplier) return;
  if (!has_multipliers || settings.detect_bifurcations == 0)
    refuse("ICP", has_multipliers ? "multipliers are not computed with ISP = 0; give ISP another value"
                                  : "there are no multipliers");
  if (monitor.number > settings.dimension)
    refuse("UZR", fmt::format("the orbit has as many multipliers as states; allowed: multiplier(1) to multiplier({})",
                              settings.dimension));
  const auto holds = [index](const HeldValue& held) { return held.parameter == index; };
  if (std::any_of(settings.held.begin(), settings.held.end(), holds))
    refuse("HOLD",
           "the modulus of a multiplier cannot be held, for it is not smooth where two of them meet; ISW = 2 follows "
           "folds, period doublings and torus bifurcations");
  if (settings.free_parameters.front() == index)
    refuse("ICP", "the modulus of a multiplier may be a further entry of ICP, not its first");
}

void check_monitors(const HybridSystem& system, const RunSettings& settings, const SettingsSource& source) {
  const std::vector<MonitorName> list = monitor_names(system, settings);
  for (std::size_t i = 0; i < list.size(); ++i)
    check_monitor(settings, first_monitor(settings) + static_cast<int>(i), list[i], source);
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

}  // namespace tchat

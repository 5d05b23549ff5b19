#include "plugin/problem_setup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "model/events.hpp"
#include "orbit/quantity.hpp"
#include "plugin/formula_file.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/constants_file.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

bool is_known(const HybridSystem& system, int k) {
  return k == system.layout().rotation() || is_own_parameter(system, k);
}

bool is_user_function(const HybridSystem& system, const std::string& name) {
  const std::optional<Quantity> quantity = find_quantity(system, name);
  return quantity && quantity->kind == Quantity::Kind::user_function;
}

/// `name` is neither a parameter nor a monitor.
[[noreturn]] void refuse(const HybridSystem& system, const std::string& name, const std::string& where) {
  std::vector<std::string> known{"period"};
  for (int k = 1; k <= system.table().user_values; ++k) known.push_back(user_function_name(system, k));
  const std::string monitors = fmt::format("{}", fmt::join(known, ", "));
  for (int k = 1; k <= system.parameters(); ++k) known.push_back(system.parameter_name(k));
  const std::vector<std::string> near = near_words(name, known);
  throw UserError(fmt::format("{}: {} is no parameter of problem {} (it has {}) and no monitor ({}, max({}), ...){}",
                              where, name, system.name(), parameter_list(system), monitors, state_in_monitor(system, 1),
                              near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, ", "))));
}

}  // namespace

bool has_further_parameters(const HybridSystem& system) {
  return system.table().initial_durations != nullptr || system.table().output_parameters != nullptr;
}

bool is_own_parameter(const HybridSystem& system, int k) {
  return k >= 1 &&
         (k <= system.parameters() || k >= system.layout().first_duration() || has_further_parameters(system));
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

std::string parameter_name(const HybridSystem& system, const RunSettings& settings, int k) {
  if (is_monitor(settings, k)) return settings.monitors[static_cast<std::size_t>(k - first_monitor(settings))];
  return is_duration(settings, k) ? settings.layout.duration_name(k) : system.parameter_name(k);
}

std::string held_text(const HybridSystem& system, const RunSettings& settings) {
  std::string text;
  for (const HeldValue& held : settings.held)
    text += (text.empty() ? "" : ", ") + parameter_name(system, settings, held.parameter);
  return text;
}

std::vector<MonitorName> monitor_names(const HybridSystem& system, const RunSettings& settings) {
  std::vector<MonitorName> list;
  for (const std::string& name : settings.monitors) list.push_back(parse_monitor(system, name, "constants"));
  return list;
}

void resolve_names(RunSettings& settings, const HybridSystem& system) {
  const ParameterLayout layout = system.layout();
  const auto segments = static_cast<int>(settings.segments.size());
  resolve_names(settings, layout, [&](const std::string& name, const std::string& where) {
    const int own = system.parameter_index(name);
    if (own > 0 && !layout.is_duration(own, segments)) return own;
    if (const std::optional<int> k = layout.duration_of_name(name)) return *k;
    const bool is_monitor = name.find('(') != std::string::npos || name == "period" || is_user_function(system, name);
    if (!is_monitor && !parse_integer(name)) refuse(system, name, where);
    if (!is_monitor) return parameter_index(system, name, where);
    parse_monitor(system, name, where);
    return names_a_monitor;
  });
}

namespace {

constexpr std::size_t longest_source = 1 << 20;  // bytes; a key has been pressed, and somebody waits

bool is_word(char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// The text with blanks in the place of comments.
std::string without_comments(std::string_view text) {
  std::string plain(text);
  char quote = '\0';
  for (std::size_t k = 0; k < plain.size(); ++k) {
    const char c = plain[k];
    if (quote != '\0') {
      if (c == '\\') ++k;
      if (c == quote || c == '\n') quote = '\0';
      continue;
    }
    if (c == '"' || c == '\'') quote = c;
    if (c != '/' || k + 1 == plain.size()) continue;
    const bool is_line = plain[k + 1] == '/';
    if (!is_line && plain[k + 1] != '*') continue;
    const std::size_t found = is_line ? plain.find('\n', k) : plain.find("*/", k + 2);
    const std::size_t end = found == std::string::npos ? plain.size() : found + (is_line ? 0 : 2);
    std::fill(plain.begin() + static_cast<std::ptrdiff_t>(k), plain.begin() + static_cast<std::ptrdiff_t>(end), ' ');
    k = end - 1;
  }
  return plain;
}

/// Behind the identifier `word`; npos when the text does not have it.
std::size_t find_behind(const std::string& text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end]))) return end;
  }
  return std::string::npos;
}

/// A name that can be typed: no blanks, quotes, backslashes or control characters.
bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isgraph(static_cast<unsigned char>(c)) != 0 && c != '"' && c != '\'' && c != '\\';
  });
}

std::vector<std::string> parameter_names_in_formulas(std::string_view text) {
  formulas::FormulaErrors mistakes;
  std::vector<std::string> names;
  for (const formulas::Assignment& parameter : formulas::read_formula_file(text, mistakes).parameters)
    names.push_back(parameter.name.text);
  return names;
}

}  // namespace

std::vector<std::string> parameter_names_in_cpp(std::string_view text) {
  const std::string plain = without_comments(text);
  std::size_t at = find_behind(plain, "parameter_names");
  if (at == std::string::npos) return {};
  at = plain.find_first_not_of("[]0123456789 \t\r\n=", at);
  std::vector<std::string> names;
  while (at != std::string::npos && plain[at] != '}') {
    if (plain[at] == '"') {
      const std::size_t end = plain.find('"', at + 1);
      if (end == std::string::npos) return {};
      names.push_back(plain.substr(at + 1, end - at - 1));
      if (!is_plain(names.back())) return {};
      at = end;
    } else if (plain[at] != '{' && plain[at] != ',') {
      return {};
    }
    at = plain.find_first_not_of(" \t\r\n", at + 1);
  }
  return names;
}

std::vector<std::string> parameter_names_in_source(const std::string& name_or_path) {
  const std::string source = source_of(name_or_path);
  if (source.empty()) return {};
  const std::string text = read_text_if_there(source, "source of the plugin", longest_source).value_or("");
  return formulas_of(source) ? parameter_names_in_formulas(text) : parameter_names_in_cpp(text);
}

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

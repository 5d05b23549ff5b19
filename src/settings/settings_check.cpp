#include "settings/settings_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "settings/constants_table.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

namespace {

using PlaceOf = std::function<Place(std::string_view)>;

/// The checks of one run's settings, in the order of the table.
class SettingsCheck {
 public:
  SettingsCheck(const RunSettings& settings, const PlaceOf& place) : settings_(settings), place_(place) {}

  /// The number, or the name that stands for it until the problem is known.
  std::string given_text(int k) const {
    return is_name(settings_, k) ? settings_.names[static_cast<std::size_t>(k - first_name)].text : std::to_string(k);
  }

  void listed_parameters() const {
    const std::vector<int>& list = settings_.free_parameters;
    if (list.empty()) refuse_constant("ICP", "ICP", "an empty list", "at least one parameter");
    for (auto k = list.begin(); k != list.end(); ++k)
      if (std::find(list.begin(), k, *k) != k)
        refuse_constant("ICP", fmt::format("ICP({})", k - list.begin() + 1),
                        fmt::format("{} twice", in_quotes(given_text(*k))), "each parameter once");
  }

  void free_parameters() const {
    const std::vector<int>& list = settings_.free_parameters;
    listed_parameters();
    for (std::size_t i = 0; i < list.size(); ++i)
      parameter_index("ICP", fmt::format("ICP({})", i + 1), list[i], segments());
    if (rules().counts_conditions) return conditions();
    const auto held = static_cast<int>(settings_.held.size());
    const int needed = free_parameter_count(settings_);
    const auto of_problem = std::count_if(
        list.begin(), list.end(), [this](int k) { return is_parameter(settings_, k) || is_name(settings_, k); });
    if (of_problem < needed)
      refuse_constant(
          "ICP", "ICP", fmt::format("{} parameters that are not durations", of_problem),
          fmt::format("at least {} with IPS = {}, ISW = {}{}; {}", needed, settings_.problem_type,
                      settings_.branch_mode, held == 0 ? "" : fmt::format(", HOLD of {}", held), rules().parameters));
  }

  /// The count of unknowns and conditions of a boundary value problem.
  void conditions() const {
    const RunSettings& s = settings_;
    if (s.boundary_conditions == 0)
      refuse_constant("NBC", "NBC", "'0'",
                      fmt::format("the number of boundary conditions, with IPS = {}", s.problem_type));
    const int functions = s.dimension * segments();
    const int needed = s.boundary_conditions + s.integral_conditions - functions + 1;
    const std::string count = fmt::format("NBC + NINT - n m + 1 = {} + {} - {} {} + 1 = {}", s.boundary_conditions,
                                          s.integral_conditions, s.dimension, segments(), needed);
    if (needed < 1)
      refuse_constant("NBC", "NBC",
                      fmt::format("{}, which leaves no parameter free: {}",
                                  in_quotes(std::to_string(s.boundary_conditions)), count),
                      fmt::format("at least {} conditions for {} functions and one parameter", functions, functions));
    if (static_cast<int>(s.free_parameters.size()) < needed)
      refuse_constant("ICP", "ICP", fmt::format("{} parameters", s.free_parameters.size()),
                      fmt::format("as many as the conditions leave free, {}; a duration is fixed unless it is among "
                                  "them",
                                  count));
  }

  /// Events and jumps of the signature: there is none where segments form no ring. In one, jump 0 is the identity, and
  /// event 0 the phase condition of an orbit without a section.
  void signature() const {
    if (rules().most_segments > 0 && segments() > rules().most_segments)
      refuse_constant(
          "GCNOSEG", "GCNOSEG", in_quotes(std::to_string(segments())),
          fmt::format("{} with IPS = {}: {}", rules().most_segments, settings_.problem_type, rules().why_most));
    int s = 0;
    for (const SegmentSettings& segment : settings_.segments) {
      ++s;
      if (rules().ends_in_events) {
        if (segment.index.event == no_function) phase_condition(s);
      } else {
        no_index("GCHIND", s, segment.index.event);
        no_index("GCGIND", s, segment.index.jump);
      }
    }
  }

  void phase_condition(int s) const {
    const auto refuse_zero = [&](const std::string& allowed) {
      refuse_constant("GCHIND", fmt::format("GCHIND({})", s), "'0'", allowed);
    };
    if (keeps_contact(settings_.problem_type))
      refuse_zero(fmt::format("an integer >= 1 with IPS = {}, whose segments end in events", settings_.problem_type));
    if (segments() > 1)
      refuse_zero(
          "an integer >= 1 in a signature of several segments: 0, the integral phase condition, stands for the one "
          "event of a smooth orbit");
  }

  void no_index(const char* keyword, int s, int index) const {
    if (index == no_function) return;
    refuse_constant(keyword, fmt::format("{}({})", keyword, s), in_quotes(std::to_string(index)),
                    fmt::format("0, or leave it out: with IPS = {} {}", settings_.problem_type, rules().why_no_events));
  }

  void bounds(std::string_view low_keyword, double low, std::string_view high_keyword, double high) const {
    if (low < high) return;
    refuse_constant(high_keyword, std::string(high_keyword), in_quotes(fmt::format("{}", high)),
                    fmt::format("a number greater than {} = {}", low_keyword, low));
  }

  void steps() const {
    if (settings_.adapt_step_every > 0 && settings_.step_max == 0.0)
      refuse_constant("DSMAX", "DSMAX", "'0'", "a finite number > 0 (0 only with IADS = 0)");
    if (settings_.adapt_step_every > 0 && settings_.step_min > settings_.step_max)
      refuse_constant("DSMIN", "DSMIN", in_quotes(fmt::format("{}", settings_.step_min)),
                      fmt::format("0 to DSMAX = {}", settings_.step_max));
  }

  void measure() const {
    const int n = settings_.dimension;
    if (settings_.measure < -n || settings_.measure > 3 * n)
      refuse_constant(
          "IPLT", "IPLT", in_quotes(std::to_string(settings_.measure)),
          fmt::format("an integer from {} to {} (-n to 3n with n = NDIM = {}): 0 L2-norm, k or -k maximum or "
                      "minimum, n+k integral, 2n+k L2-norm of U(k)",
                      -n, 3 * n, n));
  }

  void parameter_weights() const {
    std::vector<int> indices;
    for (const IndexedValue& weight : settings_.parameter_weights) {
      parameter_index("THL", "ITHL", weight.index, segments_of_run());
      indices.push_back(weight.index);
    }
    each_once("THL", indices);
  }

  void state_weights() const {
    for (const IndexedValue& weight : settings_.state_weights)
      if (weight.index < 1 || weight.index > settings_.dimension)
        refuse_constant("THU", "ITHU", in_quotes(std::to_string(weight.index)),
                        fmt::format("a state, 1 to NDIM = {}", settings_.dimension));
  }

  void user_values() const {
    for (const UserValue& value : settings_.user_values)
      parameter_index("UZR", "IUZR", value.parameter, segments_of_run());
  }

  void bounded_values() const {
    std::vector<int> indices;
    for (const BoundedValue& bounded : settings_.bounds) {
      parameter_index("BOUNDS", "BOUNDS", bounded.parameter, segments_of_run());
      indices.push_back(bounded.parameter);
    }
    each_once("BOUNDS", indices);
  }

  void test_functions() const {
    if (keeps_contact(settings_.problem_type)) return;
    std::size_t monitored = 0;
    for (const SegmentSettings& segment : settings_.segments) monitored += segment.monitor.size();
    for (std::size_t i = 0; i < settings_.test_functions.size(); ++i)
      if (settings_.test_functions[i] > static_cast<int>(monitored))
        refuse_constant("GCIPSI", fmt::format("GCIPSI({})", i + 1),
                        in_quotes(std::to_string(settings_.test_functions[i])),
                        monitored == 0 ? "none, for the GCHGRZIND lists are empty"
                                       : fmt::format("1 to {}, counted through the GCHGRZIND lists", monitored));
  }

  void grazing_segment() const {
    const auto grazing = std::count_if(settings_.segments.begin(), settings_.segments.end(),
                                       [](const SegmentSettings& segment) { return segment.type == 2; });
    if (keeps_contact(settings_.problem_type) && grazing > 1)
      refuse_constant("GCSEGTYP", "GCSEGTYP", fmt::format("{} segments that end in grazing contact", grazing),
                      "one segment of type 2 with IPS = 150");
  }

  void conserved() const {
    if (settings_.conserved.empty()) return;
    const ProblemType* type = nearest_problem_type(settings_.problem_type, settings_.branch_mode);
    if (type != nullptr && type->facts().may_conserve) return;
    refuse_constant("CONSERVED", "CONSERVED", in_quotes(settings_.conserved),
                    fmt::format("nothing with IPS = {}, ISW = {}: it is for families of periodic orbits (IPS = 180) "
                                "with ISW = 1, and for switches to them (ISW = -1); remove it with CONSERVED=",
                                settings_.problem_type, settings_.branch_mode));
  }

  void held_values() const {
    std::vector<int> indices;
    for (const HeldValue& held : settings_.held) indices.push_back(held.parameter);
    each_once("HOLD", indices);
    for (const HeldValue& held : settings_.held)
      if (!layout().is_duration(held.parameter, segments_of_run()) && !stands_in(held.parameter))
        refuse_constant("HOLD", "HOLD", in_quotes(std::to_string(held.parameter)),
                        "names of monitors, or durations (T1, T2, ...); a parameter of the problem keeps its value "
                        "unless ICP frees it");
  }

  void parameter_values() const {
    for (const RunSettings::ParameterValue& value : settings_.parameter_values)
      if (const auto index = parse_integer(value.name))
        parameter_index("PAR", fmt::format("PAR({})", value.name), *index, segments_of_run());
  }

 private:
  const ParameterLayout& layout() const { return settings_.layout; }
  const SignatureRules& rules() const { return signature_rules(settings_); }
  int segments() const { return static_cast<int>(settings_.segments.size()); }

  /// For a name or a monitor.
  bool stands_in(int k) const { return is_name(settings_, k) || is_monitor(settings_, k); }

  /// A switch to a period-doubled orbit doubles the segments. The durations of its second half have indices as far as
  /// no monitor has them.
  int segments_of_run() const {
    const int m = segments();
    return may_double_segments(settings_.branch_mode) ? std::min(2 * m, std::max(m, max_torus_segments)) : m;
  }

  void parameter_index(std::string_view keyword, const std::string& name, int k, int segment_count) const {
    if (layout().is_parameter(k, segment_count) || layout().is_duration(k, segment_count)) return;
    if (stands_in(k) && keyword != "PAR") return;
    const int first = layout().first_duration();
    const std::string durations = segment_count == 1 ? fmt::format("{} (the duration of the segment)", first)
                                                     : fmt::format("{} to {} (durations of the {} segments)", first,
                                                                   first + segment_count - 1, segment_count);
    const std::string duration = k < first ? "" : fmt::format(" ({})", layout().duration_name(k));
    refuse_constant(keyword, name, in_quotes(std::to_string(k)) + duration,
                    fmt::format("1 to {} (parameters of the problem) or {}", first - 1, durations));
  }

  /// Two of them may have come from a name and a number.
  void each_once(std::string_view keyword, std::vector<int> indices) const {
    std::sort(indices.begin(), indices.end());
    const auto twice = std::adjacent_find(indices.begin(), indices.end());
    if (twice != indices.end())
      refuse_constant(keyword, std::string(keyword), fmt::format("the index '{}' twice", *twice), "each index once");
  }

  [[noreturn]] void refuse_constant(std::string_view keyword, const std::string& name, const std::string& found,
                                    const std::string& allowed) const {
    refuse(*find_constant(keyword), name, place_(keyword), found, allowed);
  }

  const RunSettings& settings_;
  const PlaceOf& place_;
};

/// A test function of IPS 180 by its number in GCIPSI; all from 1.
struct Contact {
  int number = 0, segment = 0, event = 0;
};

std::vector<Contact> not_chosen(const RunSettings& settings) {
  std::vector<Contact> result;
  const std::vector<int>& chosen = settings.test_functions;
  if (chosen.empty() && signature_rules(settings).watches_all_contacts) return result;
  Contact contact;
  for (const SegmentSettings& segment : settings.segments) {
    ++contact.segment;
    for (const int event : segment.monitor) {
      ++contact.number;
      contact.event = event;
      if (std::find(chosen.begin(), chosen.end(), contact.number) == chosen.end()) result.push_back(contact);
    }
  }
  return result;
}

}  // namespace

void check_parameter_indices(const RunSettings& settings, const PlaceOf& place) {
  const SettingsCheck check(settings, place);
  check.free_parameters();
  check.parameter_weights();
  check.user_values();
  check.held_values();
  check.bounded_values();
  check.parameter_values();
}

void check_settings(const RunSettings& settings, const PlaceOf& place) {
  const SettingsCheck check(settings, place);
  check.signature();
  check.conserved();
  check.listed_parameters();
  check.bounds("RL0", settings.parameter_min, "RL1", settings.parameter_max);
  check.bounds("A0", settings.measure_min, "A1", settings.measure_max);
  check.steps();
  check.measure();
  check.state_weights();
  check.test_functions();
  check.grazing_segment();
}

std::vector<std::string> settings_warnings(const RunSettings& settings, const std::string& source) {
  std::vector<std::string> sentences;
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    if (!keeps_contact(settings.problem_type) && settings.segments[s].type == 2)
      sentences.push_back(
          fmt::format("{}: GCSEGTYP({}) = 2 (grazing contact) has no effect with IPS = {}; it belongs to IPS = {}",
                      source, s + 1, settings.problem_type, grazing_orbit.number));
  return sentences;
}

std::string unlocated_contacts(const RunSettings& before, const RunSettings& now) {
  const std::vector<Contact> earlier = not_chosen(before);
  const std::vector<Contact> left = not_chosen(now);
  const bool none_wanted = before.test_functions.empty() && !earlier.empty();
  const bool chooses = signature_rules(now).has_contacts_to_choose && !keeps_contact(now.problem_type);
  if (!chooses || none_wanted || left.size() <= earlier.size()) return "";
  constexpr std::size_t most = 6;
  std::string list;
  for (std::size_t i = 0; i < std::min(left.size(), most); ++i)
    list += fmt::format("{}{} (event {} on segment {})", i == 0 ? "" : ", ", left[i].number, left[i].event,
                        left[i].segment);
  return fmt::format(
      "GCHGRZIND changes and GCIPSI does not: {} test functions are not located, {}{}; GCIPSI numbers the events of "
      "all GCHGRZIND lists in order (`tchat constants NAME -e` lists them), give it too",
      left.size(), list, left.size() > most ? ", ..." : "");
}

namespace {

/// Of a monitor that is named for the first time the next one. Blanks in names would separate values in files.
int monitor_index(RunSettings& settings, std::string name, const std::string& where) {
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t'; });
  std::vector<std::string>& list = settings.monitors;
  const auto known = std::find(list.begin(), list.end(), name);
  const auto index = static_cast<int>(known - list.begin());
  if (known != list.end()) return first_monitor(settings) + index;
  if (index == max_monitors) throw UserError(fmt::format("{}: more than {} monitors are named", where, max_monitors));
  list.push_back(name);
  return first_monitor(settings) + index;
}

int index_of(RunSettings& settings, const GivenName& name, const ParameterNames& names) {
  const std::string where =
      fmt::format("{}: {} ({})", name.place.text(), name.keyword, find_constant(name.keyword)->meaning);
  const int index = names(name.text, where);
  return index == names_a_monitor ? monitor_index(settings, name.text, where) : index;
}

}  // namespace

void resolve_names(RunSettings& settings, const ParameterLayout& layout, const ParameterNames& names) {
  settings.layout = layout;
  std::vector<int> indices;
  for (const GivenName& name : settings.names) indices.push_back(index_of(settings, name, names));
  const auto resolve = [&](int& k) {
    if (is_name(settings, k)) k = indices[static_cast<std::size_t>(k - first_name)];
  };
  for (int& k : settings.free_parameters) resolve(k);
  for (IndexedValue& weight : settings.parameter_weights) resolve(weight.index);
  for (UserValue& value : settings.user_values) resolve(value.parameter);
  for (HeldValue& held : settings.held) resolve(held.parameter);
  for (BoundedValue& bounded : settings.bounds) resolve(bounded.parameter);
  settings.names.clear();
  const std::vector<GivenIndices> given = std::exchange(settings.unchecked, {});
  if (given.empty()) return;
  check_parameter_indices(settings, [&given](std::string_view keyword) {
    const auto found =
        std::find_if(given.begin(), given.end(), [&](const auto& each) { return each.keyword == keyword; });
    return found != given.end() ? found->place : Place{given.front().place.source};
  });
}

}  // namespace tchat

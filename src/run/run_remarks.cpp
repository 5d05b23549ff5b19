#include "run/run_remarks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/levels.hpp"
#include "base/words.hpp"
#include "files/run_files.hpp"
#include "model/events.hpp"
#include "model/parameter_vector.hpp"
#include "plugin/plugin_build.hpp"
#include "plugin/problem_setup.hpp"
#include "settings/constants_file.hpp"
#include "settings/problem_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

std::string inherited_bounds(const HybridSystem& system, const RunSettings& in_file, const RunSettings& used,
                             const std::vector<std::string>& overrides, const std::string& file) {
  const int before = in_file.free_parameters.front();
  const int now = used.free_parameters.front();
  if (before == now) return "";
  const RunSettings standard;
  std::string list;
  const auto add = [&](const char* keyword, double value, double standard_value) {
    if (value != standard_value && !is_overridden(overrides, keyword))
      list += fmt::format("{}{} = {:.10g}", list.empty() ? "" : ", ", keyword, value);
  };
  add("RL0", used.parameter_min, standard.parameter_min);
  add("RL1", used.parameter_max, standard.parameter_max);
  if (list.empty()) return "";
  return fmt::format("{} of {} was given for {} and now bounds {}, the new ICP(1); give RL0 and RL1 with it", list,
                     file, parameter_name(system, in_file, before), parameter_name(system, used, now));
}

std::string idle_parameters(const HybridSystem& system, const RunSettings& settings, const SelectedStart& start,
                            std::size_t free_count) {
  static constexpr std::array curves{PointType::fold, PointType::period_doubling, PointType::torus,
                                     PointType::equilibrium_fold, PointType::hopf};
  const auto begins_curve = [](int type) {
    return std::any_of(curves.begin(), curves.end(), [type](PointType t) { return type == static_cast<int>(t); });
  };
  if (problem_type(settings).facts().switches_branch || free_count != 1 ||
      !has_two_parameter_curves(settings.problem_type) ||
      std::none_of(start.types.begin(), start.types.end(), begins_curve))
    return "";
  std::string list;
  std::size_t count = 0;
  for (const int k : settings.free_parameters)
    if (is_parameter(settings, k) && ++count > free_count)
      list += fmt::format("{}{}", list.empty() ? "" : ", ", system.parameter_name(k));
  if (list.empty()) return "";
  return fmt::format(
      "{} of ICP stays fixed with ISW = 1, a mere column; ISW=2 follows the curve of {} in two parameters", list,
      type_name(start.type, start.kind));
}

namespace {

std::set<int> watched(const RunSettings& settings) {
  std::set<int> events;
  for (const SegmentSettings& segment : settings.segments) {
    events.insert(segment.index.event);
    events.insert(segment.monitor.begin(), segment.monitor.end());
  }
  return events;
}

using SegmentsByEvent = std::map<int, std::set<int>>;  // segments from 1

/// GCHGRZIND with what is missing besides what is there.
std::string monitor_lists(const RunSettings& settings, const SegmentsByEvent& missing) {
  std::string text;
  for (std::size_t s = 0; s < settings.segments.size(); ++s) {
    std::set<int> events(settings.segments[s].monitor.begin(), settings.segments[s].monitor.end());
    for (const auto& [event, segments] : missing)
      if (segments.contains(static_cast<int>(s) + 1)) events.insert(event);
    text += fmt::format("{}[{}]", s == 0 ? "" : ", ", fmt::join(events, ", "));
  }
  return fmt::format("GCHGRZIND=[{}]", text);
}

/// Is the event's function negative somewhere on segment s, in any return of a torus? Then monitoring it would make
/// every orbit inadmissible. `sizes`: of states.
bool is_negative(const HybridSystem& system, int event, const Orbit& x, const Eigen::VectorXd& sizes, int s,
                 int segments_per_return) {
  const int first = s;
  double least = 0.0;
  double scale = 0.0;
  for (; s < x.shape.segments; s += segments_per_return)
    for (int k = 0; k < x.shape.nodes_of(s); ++k) {
      const double h = system.event(event, x.node(s, k), x.par.data());
      if (!(h >= least)) least = h;
      scale = std::max(scale, std::abs(h));
    }
  const EventAt at = event_at(system, event, x.start(first), x.par.data());
  scale = std::max(scale, at.scale(x.start(first), sizes));
  return !(least >= -level::located * scale);
}

SegmentsByEvent missing_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start) {
  SegmentsByEvent missing;
  if (!system.has_successors() || !signature_rules(settings).ends_in_events) return missing;
  const std::set<int> seen = watched(settings);
  const Signature signature = settings.signature();
  const std::size_t m = signature.size();
  const Eigen::VectorXd sizes = state_sizes(system, signature, start);
  for (std::size_t s = 0; s < m; ++s) {
    const double* x = start.start(static_cast<int>(s));
    const IndexVector& before = signature[(s + m - 1) % m];
    const bool is_start = before.event == no_function;  // no event precedes an orbit without a section
    const auto following = system.successors(is_start ? IndexVector{0, 0, 0} : before, x, start.par.data());
    const int field = signature[s].field;
    if (!following ||
        std::none_of(following->begin(), following->end(), [field](const IndexVector& v) { return v.field == field; }))
      continue;
    for (const int event : relevant_events(system, *following, field, x, start.par.data()))
      if (!seen.contains(event) && !is_negative(system, event, start, sizes, static_cast<int>(s), static_cast<int>(m)))
        missing[event].insert(static_cast<int>(s) + 1);
  }
  return missing;
}

}  // namespace

std::string unwatched_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start) {
  const SegmentsByEvent missing = missing_events(system, settings, start);
  if (missing.empty()) return "";
  std::string list;
  for (const auto& [event, segments] : missing)
    list += fmt::format("{}event {} ({}) on segment {}", list.empty() ? "" : ", ", event,
                        system.function_name(FunctionKind::event, event), fmt::join(segments, ", "));
  return fmt::format(
      "{} may come next by the problem's successors, but is not monitored: orbits that it would end count as "
      "admissible; {} monitors it (GCIPSI numbers the events of these lists)",
      list, monitor_lists(settings, missing));
}

void watch_possible_events(const HybridSystem& system, RunSettings& settings, const Orbit& start) {
  for (const auto& [event, segments] : missing_events(system, settings, start))
    for (const int s : segments) settings.segments[static_cast<std::size_t>(s) - 1].monitor.push_back(event);
}

namespace {

/// ICP(1), where it is a parameter of the problem; else 0.
int principal_parameter(const RunSettings& settings) {
  const int k = settings.free_parameters.empty() ? 0 : settings.free_parameters.front();
  return is_parameter(settings, k) ? k : 0;
}

/// A parameter to vary beside `first`: one that ICP has, else the first of the problem; 0 where there is no other.
int other_parameter(int first, const RunSettings& settings, const HybridSystem& system) {
  for (const int k : settings.free_parameters)
    if (k != first && k <= system.parameters()) return k;
  for (int k = 1; k <= system.parameters(); ++k)
    if (k != first) return k;
  return 0;
}

/// The curve in two parameters of the points of a label; null where there is none.
const ProblemType* curve_of(int label_type, int number) {
  for (const ProblemType* type : problem_types_of(number, 2))
    if (type->facts().curve == label_type) return type;
  return nullptr;
}

/// Words of `tchat run` that follow the branch or curve at a label; none where there is none.
Command run_words(const NextStart& start, const RunSettings& settings, const HybridSystem& system) {
  const int principal = principal_parameter(settings);
  if (principal == 0) return {};
  const std::string first = system.parameter_name(principal);
  if (const Command words = birth_words(start.type, settings.problem_type, false, first); !words.empty()) return words;
  const int second = other_parameter(principal, settings, system);
  if (second == 0 || curve_of(start.type, settings.problem_type) == nullptr) return {};
  return {"ISW=2", fmt::format("ICP=[{},{}]", first, system.parameter_name(second))};
}

/// The same that follow an extremum of ICP(1), a monitor, in one more parameter.
Command extremum_words(const RunSettings& settings, const HybridSystem& system) {
  if (!settings.conserved.empty()) return {};
  const int first = free_problem_parameters(settings).front();
  const int second = other_parameter(first, settings, system);
  if (second == 0) return {};
  const std::string names = fmt::format("{},{},{}", parameter_name(system, settings, settings.free_parameters.front()),
                                        system.parameter_name(first), system.parameter_name(second));
  return {"ISW=2", "ICP=[" + names + "]"};
}

/// Does the end of a segment change neither the state nor the field?
bool changes_nothing(std::size_t segment, const RunSettings& settings, const HybridSystem& system) {
  const IndexVector& end = settings.segments[segment].index;
  return is_identity_jump(system, end) &&
         settings.segments[(segment + 1) % settings.segments.size()].index.field == end.field;
}

/// Is a contact alone there? At the end of a segment it is where that end changes nothing.
bool is_free_of_other_events(const UserPointKind& contact, const RunSettings& settings, const HybridSystem& system) {
  constexpr double at_the_end = level::located;
  if (contact.tau > at_the_end && contact.tau < 1.0 - at_the_end) return true;
  const std::size_t m = settings.segments.size();
  const auto segment = static_cast<std::size_t>(contact.segment - 1);
  return changes_nothing(contact.tau <= at_the_end ? (segment + m - 1) % m : segment, settings, system);
}

bool is_grazing(const UserPointKind& kind) {
  return kind.kind == UserPointKind::contact || kind.kind == UserPointKind::impact_velocity;
}

/// Is there nothing that a contact could change: one field, and no jump but identities?
bool contacts_change_nothing(const HybridSystem& system) {
  for (int k = 1; k <= system.count(FunctionKind::jump); ++k)
    if (!is_identity_jump(system, k)) return false;
  return system.count(FunctionKind::field) == 1;
}

/// Why `tchat resegment --to grazing-curve` cannot cut the orbit at this contact; "" where it can.
std::string why_no_grazing_curve(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system) {
  const SolutionFamily& family = problem_type(settings).family();
  if (const std::string reason = family.why_not(Analysis::resegmentation, ""); !reason.empty()) return reason;
  if (family.facts().has_several_returns) return "the contact is one of several coupled orbits";
  if (contacts_change_nothing(system)) return "the contact changes nothing";
  if (tangent_section(kind, settings, system)) return "the section becomes tangent, and no motion changes";
  if (kind.kind == UserPointKind::contact && !is_free_of_other_events(kind, settings, system))
    return "another event is at the contact";
  return "";
}

/// Is it a contact inside a segment, which changes nothing?
bool is_held_contact(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system) {
  const SolutionFamily& family = problem_type(settings).family();
  const bool is_orbit = family.why_not(Analysis::resegmentation, "").empty() && !family.facts().has_several_returns;
  return is_orbit && kind.kind == UserPointKind::contact && kind.tau > 0.0 && kind.tau < 1.0 && settings.held.empty() &&
         contacts_change_nothing(system);
}

/// Words of `tchat run` that keep the least value of the event function zero, and watch the other ones only.
Command held_contact_words(const UserPointKind& kind, const RunSettings& settings) {
  const auto segment = static_cast<std::size_t>(kind.segment - 1);
  const std::string place = settings.segments.size() > 1 ? fmt::format(", {}", kind.segment) : "";
  std::string others;
  int number = 0;  // GCIPSI counts through the events of all segments
  for (std::size_t s = 0; s < settings.segments.size(); ++s)
    for (const int event : settings.segments[s].monitor)
      if (const bool is_held = s == segment && event == kind.index; (++number, !is_held))
        others += fmt::format("{}{}", others.empty() ? "" : ",", number);
  return {fmt::format("HOLD={{min(h{}{}): 0}}", kind.index, place), "ISW=1", fmt::format("GCIPSI=[{}]", others)};
}

/// Words of `tchat run` that keep the margin of chatter zero where it becomes incomplete; none at other labels.
Command held_margin_words(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system) {
  if (kind.kind != UserPointKind::chatter || !settings.held.empty()) return {};
  const auto segment = static_cast<std::size_t>(kind.segment - 1);
  const tchat_chatter* const chatter = system.chatter_with_limit(settings.segments.at(segment).index.jump);
  if (chatter == nullptr) return {};
  return {fmt::format("HOLD={{end(h{}, {}): 0}}", chatter->margin, kind.segment), "ISW=1"};
}

/// Is it where a curve of equilibria in two parameters reaches a surface?
bool is_boundary_of_curve(const NextStart& start, const RunSettings& settings) {
  const ProblemFacts& facts = problem_type(settings).facts();
  const bool is_boundary = start.kind.kind == UserPointKind::boundary_equilibrium;
  return is_boundary && facts.in_two_parameters && facts.curve != -start.type;
}

/// Of a label on a curve: the name of the other curve that goes through it; "" where there is none.
std::string crossing_curve(const NextStart& start, const RunSettings& settings) {
  const std::vector<PointType> meeting = curves_through(start.type);
  const auto is_own = [&](PointType one) { return static_cast<int>(one) == start.curve; };
  const bool is_one = std::any_of(meeting.begin(), meeting.end(), is_own);
  const ProblemFacts& facts = problem_type(settings).facts();
  const bool is_usual = facts.in_two_parameters && facts.free_parameters <= 2 && !facts.switches_branch;
  if (!is_one || !is_usual || facts.keeps_contact || !settings.held.empty()) return "";
  for (const PointType other : meeting)
    if (const int type = static_cast<int>(other); !is_own(other) && curve_of(type, settings.problem_type) != nullptr)
      return curve_name(settings.problem_type, type);
  return "";
}

/// Words of `tchat run` that follow from a label of a curve another one that goes through it, or one that begins there;
/// none where there is none.
Command words_on_curve(const NextStart& start, const RunSettings& settings) {
  if (const std::string name = crossing_curve(start, settings); !name.empty()) return {"CURVE=" + name};
  return settings.held.empty() ? birth_words(start.type, settings.problem_type, true, "") : Command{};
}

/// Why ISW = 2 and two parameters do not follow the points of a label; "" where they do.
std::string why_no_curve(const NextStart& start, const RunSettings& settings) {
  const ProblemType& type = problem_type(settings);
  const int kind = start.kind.kind;
  const std::string name = type_name(start.type, start.kind);
  if (type.facts().in_two_parameters || type.facts().curve != 0)
    return fmt::format("ISW = 2 at {} of a curve continues that curve", name);
  if (!settings.held.empty()) return "HOLD keeps a monitor on the branch";
  if (kind == UserPointKind::extremum)
    return "an extremum is one of ICP(1), no special point of orbits; ISW = 2 with that monitor first in ICP follows "
           "it";
  const bool is_contact = kind == UserPointKind::contact || kind == UserPointKind::boundary_equilibrium;
  const bool has_one = is_contact || kind == UserPointKind::none;
  if (has_one && curve_of(is_contact ? -start.type : start.type, settings.problem_type) != nullptr) return "";
  if (start.type == static_cast<int>(PointType::equilibrium_branch_point))
    return "the branches that cross at a BP of equilibria part when a second parameter changes, unless a symmetry or "
           "an "
           "invariant set keeps the BP: explore at another value of that parameter";
  return fmt::format("ISW = 2 does not follow {} of {}", name, type.facts().solutions);
}

/// With a contact an impact is born; where an impact has velocity zero it vanishes. "" at other points.
std::string resegmentation_target(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system) {
  if (kind.kind == UserPointKind::contact) return is_free_of_other_events(kind, settings, system) ? "impacting" : "";
  const auto segments = static_cast<int>(settings.segments.size());
  if (kind.kind != UserPointKind::impact_velocity || kind.segment < 1 || kind.segment > segments) return "";
  const IndexVector& end = settings.segments[static_cast<std::size_t>(kind.segment - 1)].index;
  const bool is_impact = end.event == kind.index && !is_identity_jump(system, end);
  return is_impact ? "signature" : "";
}

/// `tchat run` from a label with the constants of its run.
Command run_from_label(const NextStart& start, const std::string& problem, const std::string& output) {
  return words_of({{"run"},
                   problem_words(problem),
                   {"-c", output_path('r', output), "-s", output, fmt::format("IRS={}", start.label)}});
}

/// `tchat run` from what tchat resegment has made.
Command run_from_files(const std::string& problem, const std::string& name) {
  return words_of({{"run"}, problem_words(problem), {"-c", name, "-s", name}});
}

Command resegmentation(const NextStart& start, const std::string& output, const std::string& target,
                       const std::string& name) {
  return {"resegment", output_path('q', output), std::to_string(start.label), "--to", target, "-o", name};
}

}  // namespace

NextNames names_at(const NextStart& start, const std::string& output) {
  const std::string name = fmt::format("{}_{}{}", output, type_name(start.type, start.kind), start.label);
  return {name, name, name + "_branch"};
}

Commands next_commands(const NextStart& start, const RunSettings& settings, const HybridSystem& system,
                       const std::string& problem, const std::string& output, const NextNames& names) {
  const ProblemType& type = problem_type(settings);
  const auto run = [&](const Command& words) {
    if (words.empty()) return Commands{};
    return Commands{words_of({run_from_label(start, problem, output), words, {"-o", names.branch}})};
  };
  if (type.facts().in_two_parameters) return run(words_on_curve(start, settings));
  if (type.facts().curve != 0) return {};
  if (const std::string target = resegmentation_target(start.kind, settings, system); !target.empty()) {
    const SolutionFamily& family = type.family();
    const bool is_cut = family.why_not(Analysis::resegmentation, "").empty() && !family.facts().has_several_returns;
    if (!is_cut) return {};
    return {resegmentation(start, output, target, names.start),
            words_of({run_from_files(problem, names.start), {"-o", names.branch_after_start}})};
  }
  if (start.kind.kind == UserPointKind::rule)
    return {words_of({{"simulate"},
                      problem_words(problem),
                      {"-s", output, fmt::format("IRS={}", start.label), "--dat", names.branch}})};
  const bool is_extremum = start.kind.kind == UserPointKind::extremum;
  if ((start.kind.kind != UserPointKind::none && !is_extremum) || !settings.held.empty()) return {};
  const bool has_torus = start.type == static_cast<int>(PointType::torus);
  if (has_torus && settings.segments.front().index.event == no_function) return {};  // a torus needs a section
  return run(is_extremum ? extremum_words(settings, system) : run_words(start, settings, system));
}

bool tangent_section(const UserPointKind& kind, const RunSettings& settings, const HybridSystem& system) {
  const auto segment = static_cast<std::size_t>(kind.segment - 1);
  return kind.kind == UserPointKind::impact_velocity && segment < settings.segments.size() &&
         changes_nothing(segment, settings, system);
}

CurveCommand curve_command(const NextStart& start, const RunSettings& settings, const HybridSystem& system,
                           const std::string& problem, const std::string& output, const std::string& curve) {
  const Command to_curve{"-o", curve};
  const std::string cut = curve + "_start";
  const auto from_label = [&](const Command& words, const Command& to) {
    return words_of({run_from_label(start, problem, output), words, to});
  };
  const std::string own = type_name(start.type, start.kind);
  if (is_held_contact(start.kind, settings, system))
    return {{from_label(held_contact_words(start.kind, settings), to_curve)}, "", own};
  if (const Command words = held_margin_words(start.kind, settings, system); !words.empty())
    return {{from_label(words, to_curve)}, "", own};
  const std::string no_grazing =
      is_grazing(start.kind) ? why_no_grazing_curve(start.kind, settings, system) : "no contact";
  if (no_grazing.empty())
    return {{resegmentation(start, output, "grazing-curve", cut), words_of({run_from_files(problem, cut), to_curve})},
            "",
            own};
  if (is_boundary_of_curve(start, settings))  // there ISW = 2 would continue the curve: the point as one of a branch
    return {{from_label({"ISW=1", "NMX=1"}, {"-o", cut}),
             words_of({{"run"},
                       problem_words(problem),
                       {"-c", output_path('r', cut), "-s", cut, "IRS=EP1", "ISW=2"},
                       to_curve})},
            "",
            own};
  if (const std::string name = crossing_curve(start, settings); !name.empty())
    return {{from_label({"ISW=2", "CURVE=" + name}, to_curve)}, "", name};
  const std::string why_none = why_no_curve(start, settings);
  if (why_none.empty()) return {{from_label({"ISW=2"}, to_curve)}, "", own};
  return {{}, is_grazing(start.kind) ? no_grazing : why_none, own};
}

std::vector<CurveCommand> born_curve_commands(const NextStart& start, const RunSettings& settings,
                                              const std::string& problem, const std::string& output,
                                              const std::string& curve) {
  const ProblemType* const type = birth_type(start.type, settings.problem_type, true);
  const bool begins = type != nullptr && type->facts().curve > 0;  // at a BP, a curve of the same kind crosses
  if (!problem_type(settings).facts().in_two_parameters || !begins) return {};
  const Command from_label = run_from_label(start, problem, output);
  const Command run = words_of({from_label, birth_words(start.type, settings.problem_type, true, "")});
  const std::string kind = type_name(type->facts().curve);
  const bool is_alone =
      start.type != static_cast<int>(PointType::resonance_2);  // there that of the shorter orbits ends
  if (start.type != static_cast<int>(PointType::double_hopf))
    return {{{words_of({run, {"-o", curve}})}, "", kind, is_alone}};
  std::vector<CurveCommand> all;
  for (const std::string mode : {"1", "2"}) {
    const Command which{"MODE=" + mode, "-o", curve};
    all.push_back({{words_of({run, which})}, "", kind});
    all.push_back(
        {{words_of({from_label, {"ISW=2"}, which})}, "", type_name(static_cast<int>(PointType::hopf)), false, true});
  }
  return all;
}

}  // namespace tchat

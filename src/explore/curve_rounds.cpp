#include "explore/curve_rounds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/levels.hpp"
#include "base/messages.hpp"
#include "explore/run_record.hpp"
#include "files/solution_file_reader.hpp"
#include "plugin/problem_setup.hpp"
#include "run/run_remarks.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"
#include "settings/settings_type.hpp"

namespace tchat {

/// All that the files of a run tell.
struct CurveRounds::RunFiles {
  std::string name;
  RunSettings settings;
  SolutionFile solutions;
  std::vector<CurveSection> sections;
  RunRecord record;
};

namespace {

/// In units of the ranges.
constexpr double same_place = level::located;

bool is_special(const std::string& type) { return !type.empty() && type != "EP" && type != "RG" && type != "UZ"; }

/// MX and XI are no special points of orbits.
bool may_have_curve(const std::string& type) { return is_special(type) && type != "XI" && type != "MX"; }

/// May another curve go through a label of a curve?
bool has_further_curve(const std::string& type, const std::string& kind) {
  constexpr std::array meetings = {"GR", "BE", "LPD", "LTR", "PTR", "R1", "R2", "BT", "ZH"};
  return std::find(meetings.begin(), meetings.end(), type) != meetings.end() ||
         (kind == "BE" && (type == "HB" || type == "LP"));
}

std::vector<int> xi_zeros(const LabelledSolution& solution) {
  std::vector<int> result;
  for (const UserPointKind& kind : all_kinds(solution))
    if (kind.kind == UserPointKind::xi) result.push_back(kind.index);
  return result;
}

/// "xi_1 = xi_2 = 0"
std::string zeros_text(const std::vector<int>& indices) {
  std::string text;
  for (const int n : indices) text += fmt::format("xi_{} = ", n);
  return text.empty() ? "" : text + "0";
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

/// ", on a1_GR2_curve with 3 more"
std::string ends_on(const JoinedPoint& joint, const std::string& curve) {
  std::string first;
  std::size_t others = 0;
  for (const JoinedCurve& other : joint.curves) {
    if (other.curve == curve) continue;
    if (first.empty() && !other.is_end) first = other.curve;
    ++others;
  }
  if (first.empty()) return fmt::format(", with {} other{}", others, others > 1 ? "s" : "");
  return fmt::format(", on {}", first) + (others > 1 ? fmt::format(" with {} more", others - 1) : "");
}

template <class List>
auto* find_named(List& list, const std::string& name) {
  const auto at = std::find_if(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
  return at == list.end() ? nullptr : &*at;
}

template <class List>
auto* find_label(List& labels, int number) {
  const auto at = std::find_if(labels.begin(), labels.end(), [&](const auto& one) { return one.label == number; });
  return at == labels.end() ? nullptr : &*at;
}

}  // namespace

CurveRounds::CurveRounds(const Context& context, const ParameterVector& par)
    : context_(context), commands_(context.request, context.commands, context.system, par) {
  curves_.first = context.commands.range().parameter;
  curves_.second = commands_.second().parameter;
}

void CurveRounds::follow() {
  Candidates round;
  for (const ExploredBranch& branch : context_.diagram.branches) add_curves(branch, round);
  while (!round.empty() && context_.goes_on()) round = run(round);
  settle_unfollowed();
  join();
}

CurveColumns CurveRounds::columns() const {
  const SweptRange& first = context_.commands.range();
  const SweptRange& second = commands_.second();
  return {second.parameter, context_.commands.monitors(), {first.to - first.from, second.to - second.from}};
}

CurveRounds::RunFiles CurveRounds::files_of(const std::string& name) const {
  const ExplorationCommands& commands = context_.commands;
  RunFiles files{name, read_constants_file(commands.file('r', name)), read_solution_file(commands.file('q', name)),
                 curve_sections(name, "", read_point_file(commands.file('p', name)), columns()),
                 run_record(commands.file('d', name))};
  resolve_names(files.settings, context_.system);
  return files;
}

std::vector<CurveRounds::Labelled> CurveRounds::labels_of(const RunFiles& files) const {
  std::vector<Labelled> result;
  const int principal = files.settings.free_parameters.front();
  for (const LabelledSolution& solution : files.solutions.solutions) {
    const std::string type = type_name(solution);
    if (!is_special(type)) continue;
    Labelled one;
    one.label = solution.label;
    one.type = type;
    one.start = {solution.label, label_type(solution.type), solution.kind, curve_type(solution.type)};
    one.xi_zeros = xi_zeros(solution);
    one.first = stored_parameter(solution, principal);
    one.second = stored_parameter(solution, commands_.second_index());
    for (const CurveSection& section : files.sections)
      for (std::size_t k = 0; k < section.points.size(); ++k)
        if (section.labels[k] == solution.label) one.point = section.points[k];
    one.point.place(1) = one.second / columns().widths(1);
    const auto known = files.record.admissible.find(solution.label);
    one.is_admissible = known == files.record.admissible.end() || known->second;
    one.is_section_tangent = tangent_section(solution.kind, files.settings, context_.system);
    result.push_back(std::move(one));
  }
  return result;
}

void CurveRounds::add_curves(const ExploredBranch& branch, Candidates& next) {
  const RunFiles files = files_of(branch.name);
  for (const Labelled& label : labels_of(files))
    if (may_have_curve(label.type)) add_curve(files, label, branch.has_returns, next);
}

CurveRounds::Candidate CurveRounds::candidate_at(const RunFiles& files, const Labelled& label, bool has_returns,
                                                 const CurveCommand& command) const {
  Candidate candidate;
  ExploredCurve& curve = candidate.curve;
  curve.kind = command.kind;
  curve.has_returns = has_returns;
  curve.parent = candidate.owner = files.name;
  curve.origin = fmt::format("{} {} of {}", label.type, label.label, files.name);
  candidate.label = label.label;
  candidate.start = label.point;
  candidate.why_none = label.is_admissible ? command.why_none : "the orbit there is inadmissible";
  return candidate;
}

void CurveRounds::add_curve(const RunFiles& files, const Labelled& label, bool has_returns, Candidates& next) {
  const bool rests = !family_of(files.settings).facts().headings.has_period;
  const auto command = [this, start = label.start, settings = files.settings,
                        source = files.name](const std::string& name) {
    return curve_command(start, settings, context_.system, context_.commands.problem(), context_.commands.path(source),
                         context_.commands.path(name));
  };
  Candidate candidate = candidate_at(files, label, has_returns, command(""));
  candidate.make = [this, command, source = files.name, rests](const std::string& name) {
    return commands_.curve(name, command(name).commands, source, rests);
  };
  (candidate.why_none.empty() ? next : unfollowed_).push_back(std::move(candidate));
}

void CurveRounds::add_born_curves(const RunFiles& files, const Labelled& label, bool has_returns,
                                  Candidates& next) const {
  const auto commands = [this, start = label.start, settings = files.settings,
                         source = files.name](const std::string& name) {
    return born_curve_commands(start, settings, context_.commands.problem(), context_.commands.path(source),
                               context_.commands.path(name));
  };
  std::size_t number = 0;
  for (const CurveCommand& command : commands("")) {
    Candidate candidate = candidate_at(files, label, has_returns, command);
    candidate.curve.is_born = true;
    candidate.is_alone = command.is_alone;
    candidate.make = [this, commands, number, source = files.name, rests = command.rests](const std::string& name) {
      return commands_.curve(name, commands(name)[number].commands, source, rests);
    };
    next.push_back(std::move(candidate));
    ++number;
  }
}

void CurveRounds::add_slices(const ExploredCurve& curve, const Labelled& label, Candidates& next) const {
  for (const int returns : label.xi_zeros)
    for (const int sign : {1, -1}) {
      if (returns > commands_.returns()) continue;
      Candidate candidate;
      candidate.is_slice = true;
      candidate.slice.has_returns = true;
      candidate.slice.parent = candidate.owner = curve.name;
      candidate.label = label.label;
      candidate.returns = returns;
      candidate.make = [this, at = ResonantPoint{curve.name, label.label, returns}, sign](const std::string& name) {
        return commands_.slice(name, at, sign);
      };
      next.push_back(std::move(candidate));
    }
}

/// Of the kind and at the start of a candidate, which may be at rest where orbits shrink.
std::string CurveRounds::curve_that_ends(const Candidate& candidate) const {
  const Eigen::Vector2d place = candidate.start.place.cwiseProduct(columns().widths);
  const auto ends_there = [&](const ExploredCurve& curve) {
    return curve.kind == candidate.curve.kind &&
           std::any_of(curve.ends.begin(), curve.ends.end(), [&](const CurveEnd& end) {
             return is_at({place(0), place(1), {}}, end.first, end.second);
           });
  };
  const auto found = std::find_if(curves_.curves.begin(), curves_.curves.end(), ends_there);
  return found == curves_.curves.end() ? "" : found->name;
}

/// Of a grazing curve the orbit at the label may be one that repeats.
std::string CurveRounds::known_curve(const Candidate& candidate) const {
  if (candidate.is_slice) return "";
  if (candidate.curve.is_born) return candidate.is_alone ? curve_that_ends(candidate) : "";
  if (candidate.curve.kind != "GR") return catalogue_.curve_at(candidate.curve.kind, candidate.start);
  for (const std::string& name : catalogue_.curves_through(candidate.start))
    if (const ExploredCurve* const curve = find_named(curves_.curves, name); curve != nullptr && curve->kind == "GR")
      return name;
  return "";
}

void CurveRounds::settle_unfollowed() {
  for (const Candidate& candidate : unfollowed_)
    if (const std::string known = known_curve(candidate); !known.empty())
      set_curve(candidate, known);
    else
      curves_.without[candidate.why_none].push_back(candidate.curve.origin);
}

void CurveRounds::set_curve(const Candidate& candidate, const std::string& curve) {
  for (std::vector<ExploredBranch>* const list : {&context_.diagram.branches, &curves_.slices})
    if (ExploredBranch* const branch = find_named(*list, candidate.owner))
      if (ExploredLabel* const label = find_label(branch->labels, candidate.label)) label->curve = curve;
  if (ExploredCurve* const owner = find_named(curves_.curves, candidate.owner))
    if (CurveLabel* const label = find_label(owner->labels, candidate.label); label != nullptr && curve != owner->name)
      add_once(label->leads_to, curve);
}

bool CurveRounds::is_left() {
  curves_.budget = context_.request.branches;
  if (std::ssize(curves_.curves) + std::ssize(curves_.slices) < curves_.budget) return false;
  ++curves_.left;
  return true;
}

void CurveRounds::name(Candidate& candidate) {
  const std::string name = candidate.is_slice ? context_.next_name() : fmt::format("c{}", ++named_);
  (candidate.is_slice ? candidate.slice.name : candidate.curve.name) = name;
  (candidate.is_slice ? candidate.slice.job : candidate.curve.job) = candidate.make(name);
}

/// What it finds starts the next round.
CurveRounds::Candidates CurveRounds::run(const Candidates& round) {
  Candidates tried, next;
  for (const Candidate& candidate : round) {
    const std::string known = known_curve(candidate);
    if (!known.empty())
      set_curve(candidate, known);
    else
      tried.push_back(candidate);
  }
  std::vector<CommandJob> jobs;
  for (Candidate& candidate : tried) {
    name(candidate);
    jobs.push_back(candidate.job());
  }
  const std::vector<JobResult> results = context_.runner.run(jobs);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (!results[i].was_run) {
      context_.diagram.complete = false;
      continue;
    }
    if (results[i].status == nothing_begins_status)
      curves_.without[results[i].failure].push_back(tried[i].curve.origin);
    else if (!results[i].succeeded())
      curves_.failures.push_back(fmt::format("{} failed: {}", tried[i].name(), results[i].failure));
    else if (tried[i].is_slice)
      take_slice(tried[i], next);
    else
      take_curve(tried[i], next);
  }
  return next;
}

/// One of the same round has its start, or all of it but its beginning.
std::string CurveRounds::curve_again(const Candidate& candidate, const std::vector<CurveSection>& sections) const {
  std::string known = known_curve(candidate);
  if (!known.empty()) return known;
  for (const CurveSection& section : sections)
    if (known = catalogue_.curve_of(section); known.empty()) break;
  return known;
}

void CurveRounds::take_curve(const Candidate& candidate, Candidates& next) {
  ExploredCurve curve = candidate.curve;
  const PointFile points = read_point_file(context_.commands.file('p', curve.name));
  std::vector<CurveSection> sections = curve_sections(curve.name, curve.kind, points, columns());
  std::erase_if(sections, [](const CurveSection& section) { return section.points.size() < 2; });
  if (const std::string known = curve_again(candidate, sections); !known.empty()) {
    set_curve(candidate, known);
    curves_.again.push_back(fmt::format("{} ({}): {} again", curve.name, curve.origin, known));
    return;
  }
  if (is_left()) return;
  for (CurveSection& section : sections) catalogue_.add(std::move(section));
  describe(curve);
  set_curve(candidate, curve.name);
  curves_.curves.push_back(curve);
  context_.show(fmt::format("{}: {}, {}\n", curve.name, origin_text(curve), range_text(curves_, curve)));
  const RunFiles files = files_of(curve.name);
  for (const Labelled& label : labels_of(files)) {
    if (label.type == "XI" && !curve.has_returns) add_slices(curve, label, next);
    if (!label.is_admissible) continue;
    if (has_further_curve(label.type, curve.kind)) add_curve(files, label, curve.has_returns, next);
    add_born_curves(files, label, curve.has_returns, next);
  }
}

void CurveRounds::describe(ExploredCurve& curve) const {
  const RunFiles files = files_of(curve.name);
  const PointFile points = read_point_file(context_.commands.file('p', curve.name));
  const Eigen::Vector2d widths = columns().widths;
  Eigen::Array2d least = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const CurveSection& section : files.sections)
    for (const CurvePoint& point : section.points) {
      least = least.min(point.place.array() * widths.array());
      most = most.max(point.place.array() * widths.array());
    }
  curve.first_from = least(0), curve.second_from = least(1), curve.first_to = most(0), curve.second_to = most(1);
  curve.points = files.record.points;
  curve.inadmissible = files.record.inadmissible;
  curve.lost = files.record.lost;
  for (const Labelled& label : labels_of(files))
    curve.labels.push_back({label.label,
                            label.type,
                            label.first,
                            label.second,
                            label.is_section_tangent ? "tangent section, no grazing" : zeros_text(label.xi_zeros),
                            {}});
  curve.signatures = signatures_of(points);
  const std::vector<RecordedEnd>& reasons = files.record.ends;
  for (std::size_t k = 0; k < points.sections.size(); ++k) {
    if (points.sections[k].rows.empty()) continue;
    curve.ends.push_back(
        end_of(curve, points.sections[k], reasons.size() == points.sections.size() ? reasons[k].text : ""));
  }
}

/// At the edge of the rectangle, at a label, else as the run says.
CurveEnd CurveRounds::end_of(const ExploredCurve& curve, const PointSection& section,
                             const std::string& stopped) const {
  const Eigen::Vector2d widths = columns().widths;
  const CurveSection whole = curve_sections("", "", {{section}, {}}, columns()).front();
  const Eigen::Vector2d place = whole.points.back().place.cwiseProduct(widths);
  CurveEnd end{place(0), place(1), stopped};
  if (const CurveLabel* const label = find_label(curve.labels, whole.labels.back()))
    end.reason = fmt::format("{} {}", label->type, label->label) + (label->type == "MX" ? ", " + stopped
                                                                    : label->type == "GR" && !label->detail.empty()
                                                                        ? ", " + label->detail
                                                                        : "");
  const SweptRange* const ranges[] = {&context_.commands.range(), &commands_.second()};
  for (int k = 0; k < 2; ++k)
    for (const double edge : {ranges[k]->from, ranges[k]->to})
      if (std::abs(place(k) - edge) <= same_place * widths(k))
        end.reason = fmt::format("the edge {} = {}", ranges[k]->parameter, edge);
  return end;
}

void CurveRounds::take_slice(const Candidate& candidate, Candidates& next) {
  ExploredBranch slice = candidate.slice;
  const RunFiles files = files_of(slice.name);
  if (files.record.only_at_start || files.solutions.solutions.empty()) return;
  if (is_left()) return;
  describe_points(read_point_file(context_.commands.file('p', slice.name)), context_.commands.range(), slice);
  const double second = stored_parameter(files.solutions.solutions.front(), commands_.second_index());
  slice.origin =
      fmt::format("one impact in {} return{}, at {} = {:.6g} beside XI {} of {}", candidate.returns,
                  candidate.returns > 1 ? "s" : "", curves_.second, second, candidate.label, candidate.owner);
  for (const Labelled& label : labels_of(files))
    slice.labels.push_back({label.label, label.type, label.first, "", label.is_admissible ? "" : "inadmissible", ""});
  curves_.slices.push_back(slice);
  set_curve(candidate, slice.name);
  context_.show(
      fmt::format("{}: {}, {} = {:.6g} to {:.6g}\n", slice.name, slice.origin, curves_.first, slice.from, slice.to));
  add_curves(slice, next);
}

void CurveRounds::join() {
  for (const CurveSection& section : catalogue_.sections()) {
    const ExploredCurve* const curve = find_named(curves_.curves, section.curve);
    for (std::size_t k = 0; k < section.points.size(); ++k)
      if (section.labels[k] > 0) join_label(*curve, section, k);
  }
  for (JoinedPoint& joint : curves_.joints)
    for (JoinedCurve& one : joint.curves) name_label(joint, one);
  for (const JoinedPoint& joint : curves_.joints)
    for (const JoinedCurve& one : joint.curves)
      for (CurveEnd& end : find_named(curves_.curves, one.curve)->ends)
        if (one.is_end && is_at(joint, end.first, end.second)) end.reason += ends_on(joint, one.curve);
}

bool CurveRounds::is_at(const JoinedPoint& joint, double first, double second) const {
  const Eigen::Vector2d widths = columns().widths;
  return std::abs(joint.first - first) <= same_place * widths(0) &&
         std::abs(joint.second - second) <= same_place * widths(1);
}

/// A label may be the other curve's only by its place: where orbits shrink, the equilibria have no period.
void CurveRounds::name_label(const JoinedPoint& joint, JoinedCurve& member) const {
  if (member.label > 0) return;
  for (const CurveLabel& label : find_named(curves_.curves, member.curve)->labels)
    if (is_at(joint, label.first, label.second)) {
      member.label = label.label;
      member.type = label.type;
    }
}

void CurveRounds::join_label(const ExploredCurve& curve, const CurveSection& section, std::size_t point) {
  const CurveLabel* const label = find_label(curve.labels, section.labels[point]);
  if (label == nullptr) return;
  std::vector<std::string> others = catalogue_.curves_through(section.points[point]);
  std::erase(others, curve.name);
  if (others.empty()) return;
  auto joint = std::find_if(curves_.joints.begin(), curves_.joints.end(),
                            [&](const JoinedPoint& one) { return is_at(one, label->first, label->second); });
  if (joint == curves_.joints.end()) joint = curves_.joints.insert(joint, JoinedPoint{label->first, label->second, {}});
  const auto member = [&](const std::string& name) -> JoinedCurve& {
    for (JoinedCurve& one : joint->curves)
      if (one.curve == name) return one;
    return joint->curves.emplace_back(JoinedCurve{name, 0, "", false});
  };
  for (const std::string& other : others) member(other);
  JoinedCurve& self = member(curve.name);
  self.label = label->label;
  self.type = label->type;
  self.is_end = point + 1 == section.points.size();
}

}  // namespace tchat

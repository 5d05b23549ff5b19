#include "plot/page_branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/orbit_trace.hpp"
#include "files/recorded_labels.hpp"
#include "files/run_files.hpp"
#include "files/solution_file_reader.hpp"
#include "plot/label_text.hpp"
#include "plot/page_figure.hpp"
#include "plugin/plugin_build.hpp"
#include "settings/constants_file.hpp"
#include "settings/point_type.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// The problem of the only plugin in the folder, with its path; nothing where there are none or several.
std::optional<std::string> only_problem(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const fs::path name = entry.path().filename();
    const bool is_source = !source_of(entry.path().string()).empty() && name.has_extension();
    if (is_source || name.extension() == ".so") names.insert((folder / name.stem().stem()).string());
  }
  return names.size() == 1 ? std::optional(*names.begin()) : std::nullopt;
}

/// The problem that the constants name; nothing where they cannot be read.
std::optional<std::string> problem_in(const std::string& constants) {
  try {
    return recorded_problem(read_constants_file(constants), constants);
  } catch (const UserError&) {
    return std::nullopt;
  }
}

std::optional<Command> known_problem(const BranchFile& file, const std::string& plugin, const std::string& constants) {
  if (!plugin.empty()) return problem_words(plugin);
  const std::string run = run_path(file.path);
  if (!source_of(run).empty()) return problem_words(run);
  if (const auto recorded = problem_in(constants)) return problem_words(*recorded);
  const auto only = only_problem(fs::path(file.path).parent_path());
  return only ? std::optional(problem_words(*only)) : std::nullopt;
}

}  // namespace

RestartCommand restart_command(const BranchFile& file, const std::string& plugin) {
  const std::string solutions = sibling_path(file.path, 'q');
  std::string constants;
  try {
    constants = constants_of_run(std::nullopt, solutions);
  } catch (const UserError&) {
    return {"", "", fmt::format("There is no {} with the constants of the run.", sibling_path(file.path, 'r'))};
  }
  const std::optional<Command> problem = known_problem(file, plugin, constants);
  const std::string run = run_path(file.path);
  const bool has_usual_name = output_path('q', run) == solutions;
  RestartCommand command;
  command.to_output = fmt::format("tchat run{} -c {} -s {} -o {}_", shell_words(problem.value_or(Command{"PROBLEM"})),
                                  quoted_for_shell(constants), quoted_for_shell(has_usual_name ? run : solutions),
                                  quoted_for_shell(run));
  command.to_label = " IRS=";
  if (!problem)
    command.remark =
        "Replace PROBLEM by the name of the problem: the files of a run do not hold it. With -p PROBLEM, tchat plot "
        "writes it here.";
  return command;
}

namespace {

constexpr int orbit_digits = 7;
constexpr std::size_t most_orbits = 400;                    // of regular points
constexpr std::size_t most_numbers = 300'000;               // of all orbits: 3 MB
constexpr std::size_t fewest_times = 16, most_times = 400;  // of one segment

std::string orbit_number(double value) { return page_number(value, orbit_digits); }

/// Where a solution is in the p-file.
struct SolutionPlace {
  std::size_t section = 0, row = 0;
};

/// By index in the list of solutions; those of no row are left out.
std::map<int, SolutionPlace> places_of(const BranchFile& file) {
  std::map<int, SolutionPlace> places;
  for (std::size_t s = 0; s < file.sections.size(); ++s)
    for (std::size_t k = 0; k < file.solution[s].size(); ++k)
      if (file.solution[s][k] >= 0) places.emplace(file.solution[s][k], SolutionPlace{s, k});
  return places;
}

/// Of these solutions all that are not regular points, and evenly chosen regular ones.
std::set<int> chosen_solutions(const BranchFile& file, const std::map<int, SolutionPlace>& places) {
  std::vector<int> regular;
  std::set<int> chosen;
  for (const auto& [index, place] : places) {
    const bool is_regular = file.types[place.section][place.row] == "RG";
    if (is_regular)
      regular.push_back(index);
    else
      chosen.insert(index);
  }
  const std::size_t stride = (regular.size() + most_orbits - 1) / most_orbits;
  for (std::size_t k = 0; k < regular.size(); k += stride) chosen.insert(regular[k]);
  return chosen;
}

/// At most so many indices from 0 to `count` - 1, both ends among them.
std::vector<Eigen::Index> thinned_indices(std::size_t count, std::size_t most) {
  const std::size_t stride = count <= most ? 1 : (count + most - 2) / (most - 1);
  std::vector<Eigen::Index> indices;
  for (std::size_t k = 0; k + 1 < count; k += stride) indices.push_back(static_cast<Eigen::Index>(k));
  indices.push_back(static_cast<Eigen::Index>(count) - 1);
  return indices;
}

std::string named(const std::map<int, std::string>& names, int k, const char* otherwise) {
  const auto found = names.find(k);
  return found != names.end() ? found->second : fmt::format("{} {}", otherwise, k);
}

class OrbitWriter {
 public:
  OrbitWriter(const PointSection& section, const OrbitTrace& trace, std::size_t most)
      : section_(section), trace_(trace), most_(most) {}

  std::string json(const LabelledSolution& solution) const {
    std::vector<std::string> segments;
    for (std::size_t s = 0; s < trace_.segments.size(); ++s) segments.push_back(segment(s));
    std::vector<std::string> contacts;
    for (const UserPointKind& kind : all_kinds(solution))
      if (is_inside(kind)) contacts.push_back(contact(kind));
    return page_object({{"label", fmt::format("{}", solution.label)},
                        {"period", page_number(trace_.period())},
                        {"closed", trace_.is_closed ? "1" : "0"},
                        {"segments", page_list(segments)},
                        {"contacts", page_list(contacts)}});
  }

 private:
  std::string segment(std::size_t s) const {
    const TraceSegment& segment = trace_.segments[s];
    const auto indices = thinned_indices(segment.times.size(), most_);
    std::vector<std::string> states;
    for (Eigen::Index i = 0; i < segment.states.rows(); ++i)
      states.push_back(page_list(indices, [&](Eigen::Index k) { return orbit_number(segment.states(i, k)); }));
    const auto time = [&](Eigen::Index k) { return orbit_number(segment.times[static_cast<std::size_t>(k)]); };
    return page_object({{"t", page_list(indices, time)},
                        {"u", page_list(states)},
                        {"event", page_text(event_after(s))},
                        {"jump", page_text(jump_after(s))},
                        {"jumps", trace_.jumps_after(s) ? "1" : "0"},
                        {"endsReturn", trace_.ends_return(s) ? "1" : "0"}});
  }

  /// What the segment ends in; "" where the file does not say, and for a phase condition.
  std::string event_after(std::size_t s) const {
    if (section_.signature.empty()) return "";
    const int event = section_.signature[s % section_.signature.size()].event;
    return event > 0 ? named(section_.events, event, "event") : "";
  }

  /// "jump impact", or "jump 2" without a name; "" where the file has no signature.
  std::string jump_after(std::size_t s) const {
    if (section_.signature.empty()) return "";
    const int jump = section_.signature[s % section_.signature.size()].jump;
    if (jump <= 0) return "";
    const auto name = section_.jumps.find(jump);
    return name != section_.jumps.end() ? "jump " + name->second : fmt::format("jump {}", jump);
  }

  bool is_inside(const UserPointKind& kind) const {
    const bool is_contact = kind.kind == UserPointKind::contact || kind.kind == UserPointKind::impact_velocity;
    return is_contact && kind.segment >= 1 && static_cast<std::size_t>(kind.segment) <= trace_.segments.size();
  }

  /// The place of a grazing contact: the stored time nearest to it.
  std::string contact(const UserPointKind& kind) const {
    const TraceSegment& segment = trace_.segments[static_cast<std::size_t>(kind.segment) - 1];
    const double wanted = segment.times.front() + kind.tau * (segment.times.back() - segment.times.front());
    const auto after = std::lower_bound(segment.times.begin(), segment.times.end(), wanted);
    const auto k =
        std::min<std::ptrdiff_t>(after - segment.times.begin(), static_cast<std::ptrdiff_t>(segment.times.size()) - 1);
    std::vector<std::string> states;
    for (Eigen::Index i = 0; i < segment.states.rows(); ++i) states.push_back(orbit_number(segment.states(i, k)));
    return page_object({{"t", orbit_number(segment.times[static_cast<std::size_t>(k)])},
                        {"u", page_list(states)},
                        {"text", page_text("contact with " + named(section_.events, kind.index, "event"))}});
  }

  const PointSection& section_;
  const OrbitTrace& trace_;
  std::size_t most_;
};

std::string equilibrium_json(const LabelledSolution& solution) {
  std::vector<std::string> states;
  for (Eigen::Index i = 0; i < solution.states.rows(); ++i) states.push_back(page_number(solution.states(i, 0)));
  return page_object({{"label", fmt::format("{}", solution.label)}, {"equilibrium", page_list(states)}});
}

/// How many times of each segment are embedded when there are so many orbits.
std::size_t times_of_segment(const OrbitTrace& trace, std::size_t orbits) {
  const std::size_t share = most_numbers / std::max<std::size_t>(orbits, 1);
  const std::size_t rows = trace.segments.size() * (static_cast<std::size_t>(trace.dimension()) + 1);
  return std::clamp(share / rows, fewest_times, most_times);
}

std::string orbit_json(const LabelledSolution& solution, const PointSection& section, const std::string& path,
                       int dimension, std::size_t orbits) {
  if (solution.tau.size() < 2) return equilibrium_json(solution);
  const OrbitTrace trace = family_of(solution.problem_type).trace(solution, "", dimension, path);
  return OrbitWriter(section, trace, times_of_segment(trace, orbits)).json(solution);
}

/// Why the branch has no solutions, by its own files.
std::string why_missing(const BranchFile& file, const std::string& path) {
  std::error_code error;
  if (path.empty()) return fmt::format("no q-file belongs to the name {}", file.path);
  if (!std::filesystem::is_regular_file(path, error)) return fmt::format("{} is missing", path);
  for (const std::string& warning : file.warnings)
    if (warning.starts_with(path)) return warning;
  return fmt::format("{} holds none of the labels of {}", path, file.path);
}

}  // namespace

PageOrbits page_orbits(const BranchFile& file, int dimension) {
  PageOrbits result{"[]", {}, ""};
  const std::string path = sibling_path(file.path, 'q');
  const std::map<int, SolutionPlace> places = places_of(file);
  if (places.empty()) {
    result.missing = why_missing(file, path);
    return result;
  }
  const std::set<int> chosen = chosen_solutions(file, places);
  if (chosen.size() < places.size())
    result.missing = fmt::format("the page holds {} of the {} orbits of {}", chosen.size(), places.size(), path);
  std::vector<std::string> orbits;
  try {
    const SolutionFile solutions = read_solution_file(path);
    for (const int index : chosen) {
      const LabelledSolution& solution = solutions.solutions.at(static_cast<std::size_t>(index));
      const PointSection& section = file.sections[places.at(index).section];
      orbits.push_back(orbit_json(solution, section, path, dimension, chosen.size()));
      result.place[solution.label] = orbits.size() - 1;
    }
  } catch (const UserError& error) {
    result.missing = error.what();
  }
  result.json = page_list(orbits);
  return result;
}

namespace {

std::string integer(long long value) { return fmt::format("{}", value); }

/// One character for each point: s stable, u unstable, - if stability is unknown.
std::string stability(const PointSection& section) {
  const bool is_known = section.has_stability() && section.curve_type == 0 &&
                        !has_critical_multiplier(section.problem_type, section.branch_mode);
  std::string letters;
  for (const PointRow& row : section.rows) letters += !is_known ? '-' : row.point < 0 ? 's' : 'u';
  return letters;
}

/// What numbers the d-file has of a point: a boundary value problem has none.
const char* spectrum_of(const PointSection& section) {
  const FamilyFacts& facts = family_of(section.problem_type).facts();
  return facts.has_return_map ? "multipliers" : facts.headings.has_period ? "" : "eigenvalues";
}

std::string multipliers_of(const DiagnosticPoint* point) {
  if (point == nullptr || point->multipliers.empty()) return "0";
  std::vector<std::string> parts;
  for (const auto& mu : point->multipliers) {
    parts.push_back(page_number(mu.real()));
    parts.push_back(page_number(mu.imag()));
  }
  return page_list(parts);
}

class PageBranchWriter {
 public:
  PageBranchWriter(const BranchFile& file, const PageBranchOptions& options)
      : file_(file),
        orbits_(page_orbits(file, options.dimension)),
        restart_(restart_command(file, options.plugin)),
        names_(counted_names(file.solutions)) {}

  std::string json() const {
    std::vector<std::string> sections;
    for (std::size_t s = 0; s < file_.sections.size(); ++s) sections.push_back(section(s));
    return page_object({{"name", page_text(file_.name)},
                        {"path", page_text(file_.path)},
                        {"sections", page_list(sections)},
                        {"orbits", orbits_.json},
                        {"noOrbits", page_text(orbits_.missing)},
                        {"noMultipliers", page_text(why_no_multipliers())},
                        {"restart", page_list({page_text(restart_.to_output), page_text(restart_.to_label)})}});
  }

 private:
  std::string section(std::size_t s) const {
    const PointSection& section = file_.sections[s];
    std::vector<std::string> columns, states, multipliers;
    for (std::size_t c = 0; c < section.columns.size(); ++c) columns.push_back(column(section, c));
    for (int k = 1; k <= section.dimension; ++k) states.push_back(page_text(section.state_name(k)));
    for (std::size_t k = 0; k < section.rows.size(); ++k)
      multipliers.push_back(multipliers_of(file_.diagnostic_of(s, k)));
    return page_object(
        {{"columns", page_list(section.columns, [](const std::string& name) { return page_text(name); })},
         {"values", page_list(columns)},
         {"branch", page_list(section.rows, [](const PointRow& row) { return integer(std::abs(row.branch)); })},
         {"point", page_list(section.rows, [](const PointRow& row) { return integer(std::abs(row.point)); })},
         {"stability", page_text(stability(section))},
         {"inadmissible", inadmissible(s)},
         {"fixed", fixed_parameters(s)},
         {"states", page_list(states)},
         {"multipliers", page_list(multipliers)},
         {"spectrum", page_text(spectrum_of(section))},
         {"restartRemark", page_text(why_no_restart(section))},
         {"labels", labels(s)}});
  }

  static std::string column(const PointSection& section, std::size_t c) {
    return page_list(section.rows, [c](const PointRow& row) {
      return c < row.values.size() ? page_number(row.values[c]) : std::string("null");
    });
  }

  /// {"row": why, ...}
  std::string inadmissible(std::size_t s) const {
    std::vector<std::string> rows;
    for (std::size_t k = 0; k < file_.admissible[s].size(); ++k) {
      if (file_.admissible[s][k]) continue;
      const DiagnosticPoint* point = file_.diagnostic_of(s, k);
      const std::string why = point == nullptr ? "" : violation_in(point->notes);
      rows.push_back(fmt::format("\"{}\":{}", k, page_text(why)));
    }
    return fmt::format("{{{}}}", fmt::join(rows, ","));
  }

  /// Parameters with a name that have no column and do not change along the section.
  std::string fixed_parameters(std::size_t s) const {
    const PointSection& section = file_.sections[s];
    const auto& active = section.active_parameters;
    std::vector<std::string> pairs;
    for (const auto& [k, name] : section.parameters) {
      const auto value = file_.parameters[s].find(k);
      const bool is_free = std::find(active.begin(), active.end(), k) != active.end();
      if (is_free || value == file_.parameters[s].end()) continue;
      pairs.push_back(page_list({page_text(name), page_number(value->second)}));
    }
    return page_list(pairs);
  }

  /// {"row": {...}, ...} of the points with a label.
  std::string labels(std::size_t s) const {
    std::vector<std::string> rows;
    for (std::size_t k = 0; k < file_.sections[s].rows.size(); ++k)
      if (file_.sections[s].rows[k].label > 0) rows.push_back(fmt::format("\"{}\":{}", k, label(s, k)));
    return fmt::format("{{{}}}", fmt::join(rows, ","));
  }

  std::string label(std::size_t s, std::size_t k) const {
    const int number = file_.sections[s].rows[k].label;
    const LabelledSolution* solution = file_.solution_of(s, k);
    const auto orbit = orbits_.place.find(number);
    const PointTypeFacts* type =
        find_point_type(file_.sections[s].rows[k].type, solution ? solution->kind : UserPointKind{});
    const bool restarts = solution != nullptr && restart_.exists() && has_constants_of_last(file_.sections[s]);
    return page_object(
        {{"label", integer(number)},
         {"type", page_text(file_.types[s][k])},
         {"name", name(s, k)},
         {"meaning", page_text(type == nullptr ? "" : type->meaning)},
         {"border", type != nullptr && type->is_bifurcation ? "1" : "0"},
         {"kind", page_text(solution == nullptr ? "" : kind(s, *solution))},
         {"form", page_text(normal_form(s, k))},
         {"birth", page_text(birth(s, k))},
         {"orbit", orbit == orbits_.place.end() ? "null" : integer(static_cast<long long>(orbit->second))},
         {"restarts", restarts ? "1" : "0"}});
  }

  /// Coefficient and verdict; "" where the d-file has none.
  std::string normal_form(std::size_t s, std::size_t k) const {
    const DiagnosticPoint* const point = file_.diagnostic_of(s, k);
    return point == nullptr || !point->normal_form ? "" : format_normal_form(*point->normal_form, "");
  }

  /// "PD1", or null.
  std::string name(std::size_t s, std::size_t k) const {
    if (file_.solution_of(s, k) == nullptr) return "null";
    const std::vector<std::string>& names = names_[static_cast<std::size_t>(file_.solution[s][k])];
    return names.empty() ? "null" : page_text(names.front());
  }

  /// The r-file has the constants of the last run, which --append may have added to sections of other runs.
  bool has_constants_of_last(const PointSection& section) const {
    const PointSection& last = file_.sections.back();
    return section.problem_type == last.problem_type && section.curve_type == last.curve_type &&
           section.signature == last.signature && section.active_parameters == last.active_parameters;
  }

  /// Why labels of the section have no command; "" where they have one.
  std::string why_no_restart(const PointSection& section) const {
    if (!restart_.exists() || has_constants_of_last(section)) return restart_.remark;
    return fmt::format("{} has the constants of another run, which was appended: give those of this one with -c",
                       sibling_path(file_.path, 'r'));
  }

  /// Words of a run on the branch or curve that is born at the label, or "".
  std::string birth(std::size_t s, std::size_t k) const {
    const PointSection& section = file_.sections[s];
    const std::optional<int> principal = section.parameter_of_column(0);
    if (!principal) return "";
    return shell_words(birth_words(label_type(section.rows[k].type), section.problem_type,
                                   section.is_two_parameter_curve(), section.parameter_name(*principal)));
  }

  std::string kind(std::size_t s, const LabelledSolution& solution) const {
    return description(solution, [&](int k) { return file_.sections[s].shown_parameter(k); });
  }

  bool has_multipliers_somewhere() const {
    for (std::size_t s = 0; s < file_.sections.size(); ++s)
      for (std::size_t k = 0; k < file_.sections[s].rows.size(); ++k)
        if (const DiagnosticPoint* point = file_.diagnostic_of(s, k); point != nullptr && !point->multipliers.empty())
          return true;
    return false;
  }

  /// "" where some point has multipliers, and for solutions that have none.
  std::string why_no_multipliers() const {
    const auto has_none = [](const PointSection& section) { return *spectrum_of(section) == '\0'; };
    const auto& sections = file_.sections;
    if (std::all_of(sections.begin(), sections.end(), has_none) || has_multipliers_somewhere()) return "";
    const std::string path = sibling_path(file_.path, 'd');
    std::error_code error;
    if (path.empty()) return fmt::format("no d-file belongs to the name {}", file_.path);
    if (!std::filesystem::is_regular_file(path, error)) return fmt::format("{} is missing", path);
    for (const std::string& warning : file_.warnings)
      if (warning.starts_with(path)) return warning;
    return fmt::format("{} has none; a run with ISP = 1 or 2 computes them", path);
  }

  const BranchFile& file_;
  PageOrbits orbits_;
  RestartCommand restart_;
  std::vector<std::vector<std::string>> names_;
};

}  // namespace

std::string branch_json(const BranchFile& file, const PageBranchOptions& options) {
  return PageBranchWriter(file, options).json();
}

}  // namespace tchat

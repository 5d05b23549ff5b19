#include "app/plot_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "base/number.hpp"
#include "base/user_error.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/orbit_trace.hpp"
#include "files/solution_file_reader.hpp"
#include "plot/branch_figure.hpp"
#include "plot/event_surface.hpp"
#include "plot/multiplier_figure.hpp"
#include "plot/orbit_figure.hpp"
#include "plot/underlay.hpp"
#include "settings/constant_value.hpp"
#include "settings/problem_type.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

bool has_all(const PlotItem& item) {
  return std::find(item.labels.begin(), item.labels.end(), "all") != item.labels.end();
}

void check_legend(const PlotArguments& arguments, std::size_t count, const char* what) {
  if (arguments.legend.size() > count)
    throw UserError(fmt::format("--legend is given {} times for {} {}{}", arguments.legend.size(), count, what,
                                count == 1 ? "" : "s"));
}

void refuse_labels(const PlotItem& item) {
  if (item.labels.empty()) return;
  if (item.kind == PlotItem::Kind::sweep)
    throw UserError(fmt::format("{} is a sweep, it has no labels such as {}", item.path, item.labels.front()));
  throw UserError(fmt::format("{} holds branches, labels such as {} belong to orbits: tchat plot {} {}", item.path,
                              item.labels.front(), sibling_path(item.path, 'q'), item.labels.front()));
}

bool is_points(const PlotItem& item) { return item.kind == PlotItem::Kind::points; }

/// What is shown of sweeps, with texts of the user from number `legend` on in the key.
class SweepLayers {
 public:
  SweepLayers(const std::vector<PlotItem>& items, const PlotArguments& arguments) : arguments_(arguments) {
    look_.x = arguments.x;
    look_.y = arguments.dots.empty() ? arguments.y : arguments.dots;
    look_.z = arguments.z;
    look_.grey = arguments.grey;
    for (const std::string& text : arguments.at) look_.choices.push_back(read_sweep_choice(text));
    const PlotRange range = read_plot_range(arguments.z_range, "--zrange");
    look_.z_low = range.low, look_.z_high = range.high;
    if (!arguments.z_label.empty()) look_.z_label = plain_text(arguments.z_label);
    look_.beneath_branches = std::any_of(items.begin(), items.end(), is_points);
  }

  /// How many lines it has in the key.
  std::size_t add(const SweepFile& file, std::size_t legend, std::vector<std::string>& warnings) {
    look_.clouds_before = underlay_.clouds.size();
    look_.sweep = sweeps_++;
    Underlay layer = sweep_layer(file, look_, warnings);
    for (std::size_t k = 0; k < layer.key.size() && legend + k < arguments_.legend.size(); ++k)
      layer.key[k].text = plain_text(arguments_.legend[legend + k]);
    const std::size_t lines = layer.key.size();
    underlay_.add(std::move(layer));
    return lines;
  }

  Underlay take() { return std::move(underlay_); }

 private:
  const PlotArguments& arguments_;
  SweepLook look_;
  std::size_t sweeps_ = 0;
  Underlay underlay_;
};

NamedFigure branches(const std::vector<PlotItem>& items, const PlotArguments& arguments) {
  NamedFigure result;
  std::vector<BranchFile> files;
  BranchFigureOptions options{arguments.x, arguments.y, read_label_selection(arguments), {}, {}, {}, arguments.black};
  SweepLayers sweeps(items, arguments);
  std::size_t lines = 0;  // of the key: one a file, more for a sweep in several colours
  for (const PlotItem& item : items) {
    const std::size_t k = lines;
    const bool has_legend = k < arguments.legend.size();
    if (item.kind == PlotItem::Kind::sweep) {
      SweepFile file = read_sweep(item.path);
      refuse_labels(item);
      lines += sweeps.add(file, k, result.warnings);
      if (result.name.empty()) result.name = file.name;
      result.files.sweeps.push_back(std::move(file));
      continue;
    }
    ++lines;
    if (item.kind == PlotItem::Kind::data) {
      DataFile data = read_data_file(item.path);
      options.clouds.push_back(
          {has_legend ? arguments.legend[k] : data.name, data.x_name, data.y_name, std::move(data.points)});
      result.name = data.name;
      continue;
    }
    if (has_legend) options.legend.push_back(arguments.legend[k]);
    refuse_labels(item);
    files.push_back(read_branch_file(item.path));
    for (const std::string& warning : files.back().warnings) result.warnings.push_back(warning);
  }
  check_legend(arguments, lines, lines == items.size() ? "file" : "line");
  options.underlay = sweeps.take();
  const bool has_dots = !options.underlay.clouds.empty();
  result.figure = branch_figure(files, options, &result.warnings);
  const std::string& shown = result.figure.panels.front().y.label.text;
  const bool is_norm = shown.starts_with("L_2");
  if (has_dots && !files.empty() && arguments.dots.empty() && (is_norm || shown.starts_with("max ")))
    result.warnings.push_back(
        fmt::format("branches show {}, the dots of a sweep a state at their section, which is something else; with "
                    "-y STATE@EVENT --dots STATE branches show that too (of a run with NPR=1)",
                    is_norm ? "the L2 norm" : "the largest value of a state"));
  if (!files.empty()) result.name = files.front().name;
  result.files.branches = std::move(files);
  return result;
}

struct Orbits {
  std::vector<OrbitTrace> traces;
  std::vector<std::string> states;  // names in a trajectory's heading
  std::vector<std::string> warnings;
};

void add_trajectory(const PlotItem& item, Orbits& orbits) {
  if (!item.labels.empty())
    throw UserError(fmt::format("{} is a trajectory, it has no labels such as {}", item.path, item.labels.front()));
  TrajectoryFile file = read_trajectory_file(item.path);
  orbits.traces.push_back(std::move(file.trace));
  if (orbits.states.empty()) orbits.states = file.states;
}

OrbitTrace trace_of(const LabelledSolution& solution, const std::string& name, const PlotArguments& arguments,
                    const std::string& path) {
  const SolutionFamily& family = family_of(solution.problem_type);
  return arguments.section ? family.section_trace(solution, name, arguments.dimension, path)
                           : family.trace(solution, name, arguments.dimension, path);
}

void add_orbits(const PlotItem& item, bool several_files, const PlotArguments& arguments, Orbits& orbits) {
  if (item.kind == PlotItem::Kind::trajectory) return add_trajectory(item, orbits);
  const SolutionFile file = read_solution_file(item.path);
  for (const std::string& warning : file.warnings) orbits.warnings.push_back(warning);
  const int problem_type = file.solutions.empty() ? 0 : file.solutions.front().problem_type;
  const std::map<int, LineKind> kinds = family_of(problem_type).label_kinds(item.path);
  const auto add = [&](const LabelledSolution& solution, const std::string& word) {
    const std::string name = several_files ? fmt::format("{} {}", run_name(item.path), word) : word;
    orbits.traces.push_back(trace_of(solution, name, arguments, item.path));
    if (const auto kind = kinds.find(solution.label); kind != kinds.end()) orbits.traces.back().kind = kind->second;
  };
  if (item.labels.empty() && !file.solutions.empty()) {
    std::string list;
    for (const LabelledSolution& solution : file.solutions)
      list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", solution.label, type_name(solution));
    throw UserError(fmt::format(
        "{}: which orbits? Give labels after it, by number or by type (PD1), or all; there are {}", item.path, list));
  }
  if (has_all(item)) {
    for (const LabelledSolution& solution : file.solutions)
      add(solution, fmt::format("{} {}", type_name(solution), solution.label));
    return;
  }
  for (const std::string& word : item.labels) {
    const LabelledSolution& solution = find_solution(file.solutions, read_label(word), item.path);
    const bool number = parse_integer(word).has_value();
    add(solution, number ? fmt::format("{} {}", type_name(solution), solution.label) : word);
  }
}

NamedFigure orbit_picture(const std::vector<PlotItem>& items, const PlotArguments& arguments) {
  Orbits orbits;
  for (const PlotItem& item : items) {
    if (item.kind != PlotItem::Kind::solutions && item.kind != PlotItem::Kind::trajectory)
      throw UserError(
          fmt::format("{} is no q-file; one picture shows either branches (p-files) or orbits (a q-file with "
                      "labels, or trajectories)",
                      item.path));
    add_orbits(item, items.size() > 1, arguments, orbits);
  }
  if (orbits.traces.empty()) throw UserError(fmt::format("{}: there are no solutions in it", items.front().path));
  const bool is_trajectory = items.front().kind == PlotItem::Kind::trajectory;
  const std::string name = is_trajectory ? orbits.traces.front().name : run_name(items.front().path);
  const std::string run = (fs::path(items.front().path).parent_path() / ("q." + name)).string();
  ProblemChoice choice =
      find_problem(is_trajectory ? run : items.front().path, arguments.plugin, orbits.traces.front().dimension());
  OrbitFigureOptions options;
  options.states = choice.states.empty() ? orbits.states : choice.states;
  options.parameters = choice.parameters;
  options.x = arguments.x;
  options.y = split_at_commas(arguments.y);
  options.z = arguments.z;
  options.one_panel = arguments.one_panel;
  options.legend = arguments.legend;
  options.surfaces = arguments.surfaces != "none";
  options.system = choice.system();
  if (options.surfaces) {
    for (const std::string& word : split_at_commas(arguments.surfaces)) {
      const auto event = parse_integer(word);
      if (!event)
        throw UserError(
            fmt::format("--surfaces {}: {} is no number; give the numbers of event functions, as in "
                        "--surfaces 1,3, or none",
                        arguments.surfaces, in_quotes(word)));
      options.events.push_back(*event);
    }
    if (!options.events.empty() && options.system == nullptr)
      throw UserError(
          fmt::format("--surfaces {}: the problem's plugin is needed; give it with -p", arguments.surfaces));
  }
  const bool in_time = arguments.time || (is_trajectory && arguments.x.empty() && arguments.z.empty());
  if (in_time && arguments.section)
    throw UserError("--section shows curves on a section, which have no time; leave --time out");
  if (in_time && !arguments.z.empty())
    throw UserError("-z is for phase portraits in space; leave --time out, or name the states as in --time -y x1,x2");
  const bool by_state = in_time && options.one_panel && options.y.size() != 1;
  const std::size_t states = options.y.empty() ? 2 : options.y.size();
  check_legend(arguments, orbits.traces.size() * (by_state ? states : 1), by_state ? "line" : "orbit");
  NamedFigure result;
  result.figure = in_time ? time_series(orbits.traces, options) : phase_portrait(orbits.traces, options);
  result.name = name + (in_time ? "_time" : arguments.section ? "_section" : "_orbits");
  result.warnings = orbits.warnings;
  if (!choice.warning.empty()) result.warnings.push_back(choice.warning);
  return result;
}

std::string label_list(const std::vector<DiagnosticPoint>& points) {
  std::string list;
  for (const DiagnosticPoint& point : points)
    if (point.label > 0)
      list += fmt::format("{}{}{}", list.empty() ? "" : ", ", point.label,
                          point.type.empty() ? "" : " (" + point.type + ")");
  return list.empty() ? "no labels" : list;
}

/// The points of a d-file that have these labels; types count in file order.
std::vector<DiagnosticPoint> labelled(const std::vector<DiagnosticPoint>& points, const PlotItem& item,
                                      const std::string& path) {
  std::vector<DiagnosticPoint> result;
  for (const std::string& word : item.labels) {
    const StartLabel label = read_label(word);
    int left = std::max(label.number, 1);
    const auto found = std::find_if(points.begin(), points.end(), [&](const DiagnosticPoint& point) {
      if (label.type.empty()) return point.label > 0 && point.label == label.number;
      return point.type == label.type && --left == 0;
    });
    if (found == points.end())
      throw UserError(fmt::format("{}: no point {}; there are {}", path, word, label_list(points)));
    result.push_back(*found);
  }
  return result;
}

NamedFigure multipliers(const std::vector<PlotItem>& items, const PlotArguments& arguments) {
  std::vector<MultiplierSeries> series;
  MultiplierFigureOptions options;
  for (const PlotItem& item : items) {
    const std::string sibling = sibling_path(item.path, 'd');
    const std::string path = sibling.empty() ? item.path : sibling;
    const auto points = read_diagnostics_file(path);
    if (item.labels.empty() || has_all(item)) {
      series.push_back({run_name(path), points});
      continue;
    }
    options.labelled_points = true;
    for (const DiagnosticPoint& point : labelled(points, item, path)) {
      const std::string& word = item.labels[static_cast<std::size_t>(series.size()) % item.labels.size()];
      series.push_back({items.size() > 1 ? run_name(path) + " " + word : word, {point}});
    }
  }
  check_legend(arguments, series.size(), "series");
  options.legend = arguments.legend;
  NamedFigure result;
  result.figure = multiplier_figure(series, options);
  result.name = run_name(items.front().path) + "_multipliers";
  return result;
}

}  // namespace

NamedFigure make_figure(const std::vector<PlotItem>& items, const PlotArguments& arguments) {
  if (arguments.multipliers) return multipliers(items, arguments);
  const bool orbits = std::any_of(items.begin(), items.end(), [](const PlotItem& item) {
    return item.kind == PlotItem::Kind::solutions || item.kind == PlotItem::Kind::trajectory;
  });
  if (!orbits && arguments.time)
    throw UserError("--time shows orbits: give a q-file and labels, as in tchat plot --time q.mems PD1");
  if (!orbits && arguments.section)
    throw UserError("--section shows tori: give a q-file and labels, as in tchat plot --section q.torus GR1");
  for (const PlotItem& item : items)
    if (item.kind == PlotItem::Kind::diagnostics)
      throw UserError(fmt::format("{} holds multipliers: tchat plot --multipliers {}", item.path, item.path));
  const bool sweeps =
      std::any_of(items.begin(), items.end(), [](const PlotItem& item) { return item.kind == PlotItem::Kind::sweep; });
  for (const auto& [given, option] : {std::pair(!arguments.at.empty(), "--at"), {!arguments.dots.empty(), "--dots"}})
    if (given && !sweeps)
      throw UserError(
          fmt::format("{} is for sweeps: give a file that tchat sweep has written, as in tchat plot A.sweep", option));
  if (!orbits && !sweeps && !arguments.z.empty())
    throw UserError("-z is for orbits: give a q-file and labels, as in tchat plot q.mems PD1 -x x1 -y x2 -z x3");
  return orbits ? orbit_picture(items, arguments) : branches(items, arguments);
}

}  // namespace tchat

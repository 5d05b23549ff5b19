#include "app/plot_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "files/auto_format.hpp"
#include "files/diagnostics_file.hpp"
#include "files/orbit_trace.hpp"
#include "files/solution_file_reader.hpp"
#include "plot/branch_figure.hpp"
#include "plot/event_surface.hpp"
#include "plot/multiplier_figure.hpp"
#include "plot/orbit_figure.hpp"
#include "plot/picture_output.hpp"
#include "plot/picture_sheet.hpp"
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

namespace {

void apply_taste(const PlotArguments& arguments, Figure& figure) {
  if (!arguments.title.empty()) figure.title = plain_text(arguments.title);
  const PlotRange x = read_plot_range(arguments.x_range, "--xrange");
  const PlotRange y = read_plot_range(arguments.y_range, "--yrange");
  const PlotRange z = read_plot_range(arguments.z_range, "--zrange");
  if (const auto view = read_plot_view(arguments.view)) figure.view_tilt = view->tilt, figure.view_turn = view->turn;
  for (Panel& panel : figure.panels) {
    if (panel.field && (arguments.log_x || arguments.log_y))
      throw UserError("a map in colours has linear axes: leave --logx and --logy out");
    panel.x.low = x.low, panel.x.high = x.high, panel.x.logarithmic = arguments.log_x;
    panel.y.low = y.low, panel.y.high = y.high, panel.y.logarithmic = arguments.log_y;
    if (panel.z) panel.z->low = z.low, panel.z->high = z.high;
    if (!arguments.x_label.empty()) panel.x.label = plain_text(arguments.x_label);
    if (!arguments.y_label.empty()) panel.y.label = plain_text(arguments.y_label);
    if (panel.z && !arguments.z_label.empty()) panel.z->label = plain_text(arguments.z_label);
  }
}

/// A lone figure has the usual size; panels beside each other are as wide as two thirds of it.
Sheet sheet_of(std::vector<Figure> figures, const PlotCommand& command) {
  constexpr int panel_width = 800, panel_height = 650;
  Sheet sheet;
  sheet.columns = columns_for(figures.size());
  const std::size_t rows = (figures.size() + sheet.columns - 1) / sheet.columns;
  sheet.width = panel_width * static_cast<int>(sheet.columns);
  sheet.height = panel_height * static_cast<int>(rows);
  sheet.same_ranges = command.same_ranges;
  if (const PlotSize size = read_plot_size(command.size); size.width > 0) {
    sheet.width = figures.front().width = size.width;
    sheet.height = figures.front().height = size.height;
  }
  if (command.title.size() == 1) sheet.title = plain_text(command.title.front());
  sheet.figures = std::move(figures);
  return sheet;
}

int make_picture(const PlotCommand& command) {
  refuse_control_characters(command.output, "-o");  // early, like a picture of no known form
  if (!command.output.empty()) picture_format(command.output);
  std::vector<Figure> figures;
  std::string name;
  PageContents page;
  page.options = {command.common.plugin, command.common.dimension};
  for (const PlotArguments& arguments : panel_arguments(command)) {
    NamedFigure picture = make_figure(read_plot_items(arguments.words), arguments);
    print_warnings(std::cerr, picture.warnings);
    apply_taste(arguments, picture.figure);
    figures.push_back(std::move(picture.figure));
    page.files.push_back(std::move(picture.files));
    if (name.empty()) name = picture.name;
  }
  page.name = command.output.empty() ? name : std::filesystem::path(command.output).stem().string();
  const std::string made =
      output_picture(sheet_of(std::move(figures), command), {command.output, command.script, name, std::move(page)});
  if (!made.empty()) fmt::print("{}\n", made);
  return 0;
}

constexpr const char* footer =
    "Kinds of picture, by the files given:\n"
    "  tchat plot p.A [p.B ...]           branches, or curves in two parameters\n"
    "  tchat plot p.A [p.B ...] TABLE     dots beneath: the first two columns of a table of your own\n"
    "  tchat plot A.sweep [B.sweep ...]   dots over one quantity, also beneath branches; a map over two\n"
    "  tchat plot q.A LABEL [LABEL ...]   orbits: phase portraits or time series; labels as 5, PD1, or all\n"
    "  tchat plot --section q.A LABEL     tori (without --section: the returns, coloured by their angle)\n"
    "  tchat plot A.trajectory            a simulation: time series, or with -x a phase portrait\n"
    "  tchat plot --multipliers q.A ...   Floquet multipliers (from d.A) along the branch, or at labels\n"
    "Solid: stable; dashed: unstable; dotted: inadmissible (by d.A), which may be outside the axes.\n"
    "Branches are drawn up to the bounds RL0, RL1, A0, A1 of their runs.\n"
    "Columns: a heading (alpha, 'MAX x1', L2-NORM), PAR(k), or a number. x2@wall is the state x2 at the\n"
    "end of segments that end in the event or jump wall (x2@1: of segment 1), x2@after:wall after the\n"
    "jump, of the orbits in q.A (all with NPR=1). Of a sweep, x1@+2 is x1 two rows later. Expressions\n"
    "are gnuplot's, as 'sqrt(x2@wall**2)'. Axes, ranges and texts: once for all panels, or once for each.\n"
    "Without -o the picture opens in a window; without a display it goes to A.png.\n"
    "Examples:\n"
    "  tchat plot p.impacting p.doubled -x 1/omega -y x2@wall -o arms.png\n"
    "  tchat plot p.impacting brute.sweep -y x2@wall --dots x2\n"
    "  tchat plot q.impacting GR1 PD1 -p linosc -o orbits.pdf\n"
    "  tchat plot simulated.sweep --panel mapped.sweep --same-ranges -o both.png\n"
    "  tchat plot p.impacting -o diagram.html";

}  // namespace

void add_plot_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command = app.add_subcommand(
      "plot", "bifurcation diagrams, orbits and multipliers to PNG, SVG, PDF, a page (HTML) or a window");
  command->footer(footer);
  const auto command_line = std::make_shared<PlotCommand>();
  PlotArguments* const a = &command_line->common;
  PlotCommand* const c = command_line.get();
  command
      ->add_option("FILES", a->words,
                   "p-files, sweeps, trajectories, tables, or a q-file with labels; A means p.A, before labels q.A")
      ->required();
  command->add_flag("--multipliers", a->multipliers, "Floquet multipliers with the unit circle");
  command->add_flag("--section", a->section, "tori as closed curves on their section");
  command->add_flag("--time", a->time, "orbits as time series");
  command->add_flag("--one-panel", a->one_panel, "time series of all states in one panel");
  command->add_option("-o,--output", c->output, "FILE.png, .svg, .pdf, or .html (a page for a browser)")
      ->type_name("FILE");
  // Once for all panels, or once for each.
  const auto each = [command](const char* name, std::vector<std::string>& texts, const char* help, const char* type) {
    command->add_option(name, texts, help)->type_name(type)->allow_extra_args(false);
  };
  each("-x", c->x, "x-axis: a column or expression, see below; orbits: a state", "COLUMN");
  each("-y", c->y, "y-axis; time series and sweeps take several, as x1,x2", "COLUMN");
  each("-z", c->z, "orbits: third state, in space; sweeps: colours (kind, period, lambda1)", "COLUMN");
  each("--dots", c->dots, "y-axis of sweeps beneath branches, if it is not -y", "COLUMN");
  command->add_option("--at", a->at, "only this value of a sweep, as mu=-0.8 or start=2; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_option("--panel", c->panels, "files of a further panel; may be repeated")
      ->type_name("FILES")
      ->expected(1, -1)
      ->inject_separator();
  command->add_flag("--same-ranges", c->same_ranges, "the same ranges in all panels");
  each("--xrange", c->x_range, "range of x, as 0.5:2 or 0.5:", "A:B");
  each("--yrange", c->y_range, "range of y", "A:B");
  each("--zrange", c->z_range, "range of z or colours", "A:B");
  command->add_option("--view", a->view, "tilt from the z-axis and turn around it, in degrees [65,35]")
      ->type_name("TILT,TURN");
  command->add_flag("--logx", a->log_x, "logarithmic x-axis");
  command->add_flag("--logy", a->log_y, "logarithmic y-axis");
  each("--title", c->title, "text above the picture, or above each panel", "TEXT");
  each("--xlabel", c->x_label, "text of the x-axis", "TEXT");
  each("--ylabel", c->y_label, "text of the y-axis", "TEXT");
  each("--zlabel", c->z_label, "text of the z-axis or colours", "TEXT");
  command->add_option("--legend", a->legend, "text in the key; once for each file, orbit or line")
      ->type_name("TEXT")
      ->allow_extra_args(false);
  command->add_option("--labels", a->labels, "types of points to label, as LP,PD,EP; all; none")->type_name("TYPES");
  command->add_flag("--no-labels", a->no_labels, "no special points");
  command->add_flag("--black", a->black, "branches in black, curves of a kind alike: no names in the key");
  command->add_flag("--grey", a->grey, "dots of a sweep in one grey, from whatever start");
  command->add_flag("--numbers", a->numbers, "labels with their numbers");
  command
      ->add_option("-p,--problem", a->plugin,
                   "problem P.so, P.cpp or P.tch: for event surfaces, and for the commands on a page")
      ->type_name("P");
  command->add_option("--surfaces", a->surfaces, "event functions to draw, as 1,3; none")->type_name("LIST");
  command->add_option("--dimension", a->dimension, "number of states of one segment, for older files")
      ->check(CLI::PositiveNumber);
  command->add_option("--size", c->size, "size in pixels [1200x900; 800x650 a panel]; 150 are an inch of a PDF")
      ->type_name("WxH");
  command->add_option("--script", c->script, "write the gnuplot script with its data to FILE")->type_name("FILE");
  command->callback([&chosen, command_line] { chosen = [command_line] { return make_picture(*command_line); }; });
}

}  // namespace tchat

#include "app/plot_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "app/plot_arguments.hpp"
#include "app/plot_pictures.hpp"
#include "base/user_error.hpp"
#include "base/warnings.hpp"
#include "plot/picture_output.hpp"
#include "plot/picture_sheet.hpp"

namespace tchat {

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
  page.name = name;
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

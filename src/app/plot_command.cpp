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
#include "constants/user_error.hpp"
#include "plot/picture_format.hpp"
#include "plot/picture_output.hpp"
#include "run/warnings.hpp"

namespace tchat {

namespace {

void apply_taste(const PlotArguments& arguments, Figure& figure) {
  if (!arguments.title.empty()) figure.title = plain_text(arguments.title);
  if (const PlotSize size = read_plot_size(arguments.size); size.width > 0) {
    figure.width = size.width;
    figure.height = size.height;
  }
  const PlotRange x = read_plot_range(arguments.x_range, "--xrange");
  const PlotRange y = read_plot_range(arguments.y_range, "--yrange");
  for (Panel& panel : figure.panels) {
    panel.x.low = x.low, panel.x.high = x.high, panel.x.logarithmic = arguments.log_x;
    panel.y.low = y.low, panel.y.high = y.high, panel.y.logarithmic = arguments.log_y;
    if (!arguments.x_label.empty()) panel.x.label = plain_text(arguments.x_label);
    if (!arguments.y_label.empty()) panel.y.label = plain_text(arguments.y_label);
  }
}

int make_picture(const PlotArguments& arguments) {
  const std::vector<PlotItem> items = read_plot_items(arguments.words);
  refuse_control_characters(arguments.output, "-o");  // early, like a picture of no known form
  if (!arguments.output.empty()) picture_format(arguments.output);
  NamedFigure picture = make_figure(items, arguments);
  print_warnings(std::cerr, picture.warnings);
  apply_taste(arguments, picture.figure);
  const std::string made = output_picture(picture.figure, {arguments.output, arguments.script, picture.name});
  if (!made.empty()) fmt::print("{}\n", made);
  return 0;
}

constexpr const char* footer =
    "Four kinds of picture, by the files given:\n"
    "  tchat plot p.A [p.B ...]           branches: by default the first free parameter and the solution measure;\n"
    "                                     the two free parameters when all files are two-parameter curves\n"
    "  tchat plot p.A [p.B ...] TABLE     with the first two columns of a table of your own as dots beneath\n"
    "  tchat plot q.A LABEL [LABEL ...]   orbits: phase portrait of the first two states, or with --time time series;\n"
    "                                     labels are numbers or types with a count (5, PD1, GR1), or all\n"
    "  tchat plot A.trajectory            a simulation: time series, or with -x a phase portrait\n"
    "  tchat plot --multipliers q.A ...   Floquet multipliers (from d.A) along the branch, or at labels\n"
    "Stable branches are solid, unstable ones dashed, inadmissible ones (from d.A) dotted; these set no range of the\n"
    "axes where there are others (--xrange, --yrange show more). Columns are named by their heading (alpha, 'MAX x1',\n"
    "L2-NORM), as PAR(k), or by number; a parameter that is fixed has its value from q.A.\n"
    "Without -o the picture is shown in a window; without a display it goes to A.png.\n"
    "Examples:\n"
    "  tchat plot p.impacting                                  to impacting.png, or a window\n"
    "  tchat plot p.impacting -y 'MAX x2' -o impacting.pdf\n"
    "  tchat plot p.grazing_curve p.fold_curve p.period_doubling_curve -o diagram.png\n"
    "  tchat plot q.impacting GR1 PD1 -p linosc -o orbits.png\n"
    "  tchat plot --time q.impacting PD1 -y x1,x2,y1 -o series.svg\n"
    "  tchat plot linosc.trajectory -y x1,x2 --xrange 0:50     what tchat simulate linosc has written\n"
    "  tchat plot --multipliers q.impacting -o multipliers.png";

}  // namespace

void add_plot_command(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* command =
      app.add_subcommand("plot", "Bifurcation diagrams, orbits and multipliers to PNG, SVG, PDF or a window");
  command->footer(footer);
  const auto a = std::make_shared<PlotArguments>();
  command
      ->add_option("FILES", a->words,
                   "p-files; a q-file with labels; trajectories; tables; A is taken for p.A, before labels for q.A")
      ->required();
  command->add_flag("--multipliers", a->multipliers, "Floquet multipliers with the unit circle");
  command->add_flag("--time", a->time, "orbits as time series");
  command->add_flag("--one-panel", a->one_panel, "time series of several states in one panel");
  command->add_option("-o,--output", a->output, "picture FILE.png, FILE.svg or FILE.pdf")->type_name("FILE");
  command->add_option("-x", a->x, "column, or state of a phase portrait, along x")->type_name("COLUMN");
  command->add_option("-y", a->y, "column or state along y; time series take several states, as x1,x2")
      ->type_name("COLUMN");
  command->add_option("--xrange", a->x_range, "range of x, as 0.5:2 or 0.5:")->type_name("A:B");
  command->add_option("--yrange", a->y_range, "range of y")->type_name("A:B");
  command->add_flag("--logx", a->log_x, "logarithmic x-axis");
  command->add_flag("--logy", a->log_y, "logarithmic y-axis");
  command->add_option("--title", a->title, "text above the picture");
  command->add_option("--xlabel", a->x_label, "text of the x-axis");
  command->add_option("--ylabel", a->y_label, "text of the y-axis");
  command->add_option("--legend", a->legend, "text in the key for a file or an orbit; once for each, in their order")
      ->type_name("TEXT")
      ->allow_extra_args(false);
  command->add_option("--labels", a->labels, "types of points to label, as LP,PD,EP; all; none")->type_name("TYPES");
  command->add_flag("--no-labels", a->no_labels, "no special points");
  command->add_flag("--numbers", a->numbers, "labels with their numbers");
  command
      ->add_option("-p,--problem", a->plugin,
                   "plugin P.so, P.cpp or P.tch, which draws event surfaces; without it no plugin is loaded")
      ->type_name("P");
  command->add_option("--surfaces", a->surfaces, "event functions to draw, as 1,3; none")->type_name("LIST");
  command
      ->add_option("--dimension", a->dimension, "number of states of one segment, for older files that do not say it")
      ->check(CLI::PositiveNumber);
  command->add_option("--size", a->size, "size in pixels (default: 1200x900); 150 pixels are an inch of a PDF")
      ->type_name("WxH");
  command->add_option("--script", a->script, "keep the gnuplot script, data inline, in FILE")->type_name("FILE");
  command->callback([&chosen, a] { chosen = [a] { return make_picture(*a); }; });
}

}  // namespace tchat

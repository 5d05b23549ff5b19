/// The command `tchat plot`, and the pictures that its files and options stand for.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>
#include <vector>

#include "app/plot_arguments.hpp"
#include "plot/figure.hpp"
#include "plot/page.hpp"

namespace tchat {

// From files and options to a figure: which kind of picture is meant, and the data for it.

struct NamedFigure {
  Figure figure;
  std::string name;  ///< for a file that the user did not name
  std::vector<std::string> warnings;
  FigureFiles files = {};  ///< of its computed points and of its dots
};

/// Throws UserError for files and labels that do not fit the kind of picture.
NamedFigure make_figure(const std::vector<PlotItem>& items, const PlotArguments& arguments);

// `tchat plot`: bifurcation diagrams, orbits and multipliers as PNG, SVG, PDF or HTML files or in a window.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that makes the picture and returns the exit
/// status. That call throws UserError for files, labels, columns and ranges that cannot be used and for a missing
/// gnuplot, ComputationError when gnuplot fails.
void add_plot_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

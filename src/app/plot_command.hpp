/// `tchat plot`: bifurcation diagrams, orbits and multipliers as PNG, SVG, PDF or HTML files or in a window.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that makes the picture and returns the exit
/// status. That call throws UserError for files, labels, columns and ranges that cannot be used and for a missing
/// gnuplot, ComputationError when gnuplot fails.
void add_plot_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

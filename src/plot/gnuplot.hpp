/// The program gnuplot as a child process. Its name is searched along PATH; no shell is involved.
#pragma once

#include <string>
#include <vector>

#include "plot/figure.hpp"

namespace tchat {

/// The terminals that the installed gnuplot has. Throws UserError with the cure when there is no gnuplot.
std::vector<std::string> gnuplot_terminals();

/// What gnuplot prints when it runs a script, complaints included. Throws UserError when there is no gnuplot.
std::string gnuplot_output(const std::string& script);

/// Runs a script. Throws UserError when there is no gnuplot, ComputationError with gnuplot's message when it fails.
/// `stay`: windows stay open after gnuplot's end.
void run_gnuplot(const std::string& script, bool stay = false);

/// Can windows be opened: is there a display?
bool has_display();

}  // namespace tchat

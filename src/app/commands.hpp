/// The subcommands that compute, simulate and read the files of a run.
#pragma once

#include <CLI/App.hpp>
#include <functional>

#include "files/run_files.hpp"

namespace tchat {

// Each adds its subcommand. When the user chooses it, `chosen` becomes the call that does it and returns the exit
// status. That call throws UserError for input that cannot be used.

/// All words of `tchat run` but NAME, stored in `request`, which outlives the command.
void add_run_options(CLI::App& command, RunRequest& request);
/// `tchat run NAME`: one branch. Exit status 0, 1, or 128 + the signal after Ctrl-C or SIGTERM.
void add_run_command(CLI::App& app, std::function<int()>& chosen);
/// `tchat resegment`: starting data and constants where the signature changes.
void add_resegment_command(CLI::App& app, std::function<int()>& chosen);
void add_explore_command(CLI::App& app, std::function<int()>& chosen);
/// `tchat grazing`: the local analysis of grazing contact.
void add_grazing_command(CLI::App& app, std::function<int()>& chosen);

/// `tchat simulate`: forward integration with events, from a state to the attractor.
void add_simulate_command(CLI::App& app, std::function<int()>& chosen);
void add_sweep_command(CLI::App& app, std::function<int()>& chosen);

/// `tchat labels q.NAME`: the labelled solutions of a q-file, with what each is.
void add_labels_command(CLI::App& app, std::function<int()>& chosen);
/// `tchat orbit q.NAME LABEL`: one orbit in physical time, all segments, as a table.
void add_orbit_command(CLI::App& app, std::function<int()>& chosen);
/// `tchat table p.NAME`: the points of a run as CSV or JSON for other programs.
void add_table_command(CLI::App& app, std::function<int()>& chosen);
/// `tchat verify q.NAME [LABEL ...]`: labelled orbits against forward integration. Exit status 0, or 1 when a label is
/// beyond the tolerance.
void add_verify_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

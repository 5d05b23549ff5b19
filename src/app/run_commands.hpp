/// Commands that compute from data and labels: run, resegment, explore and grazing.
#pragma once

#include <CLI/App.hpp>
#include <functional>

#include "files/run_files.hpp"

namespace tchat {

// `tchat run NAME`: one branch.

/// Adds all words of the command but NAME, stored in `request`, which outlives the command.
void add_run_options(CLI::App& command, RunRequest& request);

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that does the run and returns the exit
/// status (0, 1, or 128 + the signal after Ctrl-C or SIGTERM).
void add_run_command(CLI::App& app, std::function<int()>& chosen);

// `tchat resegment`: starting data and constants where the signature changes.

void add_resegment_command(CLI::App& app, std::function<int()>& chosen);

// `tchat explore`.

/// `chosen` becomes what the command does.
void add_explore_command(CLI::App& app, std::function<int()>& chosen);

// `tchat grazing`: the local analysis of grazing contact.

void add_grazing_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

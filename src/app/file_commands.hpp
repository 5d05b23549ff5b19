/// Commands on the files of a run: labels, orbit, table and verify.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

// `tchat labels q.NAME`: the labelled solutions of a q-file, with what each is.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for a file that cannot be read.
void add_labels_command(CLI::App& app, std::function<int()>& chosen);

// `tchat orbit q.NAME LABEL`: one orbit in physical time, all segments, as a table.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for a file that cannot be read and a label that it does not have.
void add_orbit_command(CLI::App& app, std::function<int()>& chosen);

// `tchat table p.NAME`: the points of a run as CSV or JSON for other programs.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for files that cannot be read or do not belong together.
void add_table_command(CLI::App& app, std::function<int()>& chosen);

// `tchat verify q.NAME [LABEL ...]`: labelled orbits against forward integration.

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that verifies and returns the exit status:
/// 0, or 1 when a label is beyond the tolerance. That call throws UserError for wrong input.
void add_verify_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat table p.NAME`: the points of a run as CSV or JSON for other programs.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for files that cannot be read or do not belong together.
void add_table_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat orbit q.NAME LABEL`: one orbit in physical time, all segments, as a table.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for a file that cannot be read and a label that it does not have.
void add_orbit_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat labels q.NAME`: the labelled solutions of a q-file, with what each is.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that prints the table and returns the exit
/// status. That call throws UserError for a file that cannot be read.
void add_labels_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

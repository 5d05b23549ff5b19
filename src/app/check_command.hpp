/// `tchat check NAME`: the problem's derivatives against finite differences, its dimension, its names.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that does it and returns the exit status:
/// 0 fine, 1 a fault was found. That call throws UserError for a plugin that cannot be loaded and for bad values.
void add_check_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat dat NAME`: NAME.dat -> q.NAME with the data as label 1 (TC-HAT's @gmdat).
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that does it and returns the exit status.
void add_dat_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

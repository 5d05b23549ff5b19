/// `tchat explore`.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// `chosen` becomes what the command does.
void add_explore_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat sweep`
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_sweep_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat new NAME`: a folder with a problem to start from.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_new_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// `tchat constants [NAME]`: a constants file in the other form, or explained; without NAME, what constants there are.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_constants_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

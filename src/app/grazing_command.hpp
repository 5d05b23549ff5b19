/// `tchat grazing`: the local analysis of grazing contact.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_grazing_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

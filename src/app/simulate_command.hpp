/// `tchat simulate`: forward integration with events, from a state to the attractor.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_simulate_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

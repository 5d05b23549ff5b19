/// Commands that simulate: simulate and sweep.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

// `tchat simulate`: forward integration with events, from a state to the attractor.

void add_simulate_command(CLI::App& app, std::function<int()>& chosen);

// `tchat sweep`

void add_sweep_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

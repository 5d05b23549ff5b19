/// `tchat resegment`: starting data and constants where the signature changes.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

void add_resegment_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

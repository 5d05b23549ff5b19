/// `tchat verify q.NAME [LABEL ...]`: labelled orbits against forward integration.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace tchat {

/// Adds the subcommand. When the user chooses it, `chosen` becomes the call that verifies and returns the exit status:
/// 0, or 1 when a label is beyond the tolerance. That call throws UserError for wrong input.
void add_verify_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

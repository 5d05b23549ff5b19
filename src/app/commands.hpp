/// The commands that help, completion and messages know: all but the hidden ones, which are for scripts.
#pragma once

#include <CLI/App.hpp>
#include <vector>

namespace tchat {

inline std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) commands.push_back(command);
  return commands;
}

}  // namespace tchat

/// The options of a command that prints a table for other programs: one for each format.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "files/table_writer.hpp"

namespace tchat {

/// The format that the user asks for, as a place in table_formats(); nothing without one.
using ChosenFormat = std::shared_ptr<std::optional<std::size_t>>;

/// Adds --csv, --json, ..., of which one may be given.
inline ChosenFormat add_table_formats(CLI::App& command) {
  auto chosen = std::make_shared<std::optional<std::size_t>>();
  std::vector<CLI::Option*> before;
  for (std::size_t k = 0; k < table_formats().size(); ++k) {
    const TableFormatName& format = table_formats()[k];
    CLI::Option* option = command.add_flag_callback(
        std::string("--") + format.option, [chosen, k] { *chosen = k; }, format.what);
    for (CLI::Option* other : before) option->excludes(other);
    before.push_back(option);
  }
  return chosen;
}

}  // namespace tchat

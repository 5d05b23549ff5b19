/// The command line's own account of itself: help, manual pages, completion, and messages about wrong usage.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>
#include <vector>

namespace tchat {

// The commands that help, completion and messages know: all but the hidden ones, which are for scripts.

inline std::vector<const CLI::App*> visible_commands(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) commands.push_back(command);
  return commands;
}

// How help looks: at most 100 columns, words of this program.

/// For the program, before its commands are added: they inherit it.
void set_help_format(CLI::App& app);

// What is said of a command line that cannot be parsed.

/// One message: the command, what was found, near commands or options, where help is. `app` has been parsed in vain.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

// Pages for man(1), from the help that the program itself has.

/// The page of the program, or of one of its commands (`command` may be null), in the man macros of roff.
std::string manual_page(const CLI::App& app, const CLI::App* command);

/// The hidden command `tchat manual FOLDER`: writes tchat.1 and a page for every command, tchat-run.1 and so on.
void add_manual_command(CLI::App& app, std::function<int()>& chosen);

// `tchat complete -- WORD...`, for the shells' completion: what could stand in the place of the last word.

/// Prints one candidate a line; one that ends in = wants a value at once, one that ends in / a file of that folder.
/// `words` are those after `tchat complete`: any words, so that they are not parsed. Files that cannot be read give no
/// candidates, and no messages. Returns the exit status.
int print_completions(const CLI::App& app, std::vector<std::string> words);

}  // namespace tchat

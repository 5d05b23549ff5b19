/// Pages for man(1), from the help that the program itself has.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <string>

namespace tchat {

/// The page of the program, or of one of its commands (`command` may be null), in the man macros of roff.
std::string manual_page(const CLI::App& app, const CLI::App* command);

/// The hidden command `tchat manual FOLDER`: writes tchat.1 and a page for every command, tchat-run.1 and so on.
void add_manual_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace tchat

/// Calls of tchat as data, and as a user would type them.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

namespace tchat {

/// The words of one call behind the program's name: {"run", "ball", "-o", "b"}.
using Command = std::vector<std::string>;
/// Calls, each of which needs the success of those before it.
using Commands = std::vector<Command>;

/// One list after the other.
Command words_of(std::initializer_list<Command> parts);

/// Quoted for the shell, with a blank before each.
std::string shell_words(const Command& words);
/// "tchat run ball -o b"
std::string shell_line(const Command& command);
/// Joined by " && "; "" for none.
std::string shell_line(const Commands& commands);

}  // namespace tchat

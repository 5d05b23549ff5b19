/// Words, lines and numbers of texts, suggestions for words that are not known, and calls of tchat.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// A word for a message: cut when long, unprintable characters replaced, in quotes.
std::string in_quotes(std::string_view text);

/// A word as a POSIX shell reads it: in single quotes unless it needs none.
std::string quoted_for_shell(const std::string& word);

/// The blank-separated words of a line.
std::vector<std::string_view> split_words(std::string_view line);

/// `text` without the blanks, tabs and carriage returns around it.
std::string_view trimmed(std::string_view text);

/// `line` without a carriage return at its end.
std::string_view without_carriage_return(std::string_view line);

/// In capitals, where they are letters of ASCII.
std::string upper(std::string_view word);

/// Those of `known` that are spelled much like `word` or contain it, in any case, best first, at most five.
std::vector<std::string> near_words(std::string_view word, std::span<const std::string> known);

// Numbers in texts: one reader for constants, files, formulas and the command line.

/// The whole text as a finite number with exponent letter e, E, d or D: `1.5`, `+1.5E-03`, `1.5d-03`. Nothing
/// for any other text, for inf and nan, and for numbers out of the range of double.
std::optional<double> parse_real(std::string_view text);

/// As Fortran programs write them: `1.5E-101` may be `1.5-101`, a three-digit exponent without its letter; a number too
/// small for a double is zero.
std::optional<double> parse_fortran_real(std::string_view text);

/// The whole text as an integer; nothing for one whose negative is no int: signs are taken off everywhere.
std::optional<int> parse_integer(std::string_view text);

// Calls of tchat as data, and as a user would type them.

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

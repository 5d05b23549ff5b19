/// Lines and words of texts, and words in messages.
#pragma once

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

}  // namespace tchat

/// Text for the terminal.
#pragma once

#include <string>
#include <string_view>

namespace tchat {

/// The text with '?' in the place of control characters other than newlines: names and words of files reach messages,
/// and must not reach the terminal as commands.
std::string printable(std::string_view text);

}  // namespace tchat

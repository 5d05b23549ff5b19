/// Long lines for the screen.
#pragma once

#include <string>

namespace tchat {

/// Lines of at most 120 characters, broken at blanks, the further ones indented; the last ends with a newline too.
std::string folded(std::string line);

}  // namespace tchat

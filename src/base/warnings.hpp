/// Warnings on the screen, the one way they look.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace tchat {

/// "tchat: warning: TEXT" for each, printable.
void print_warnings(std::ostream& stream, const std::vector<std::string>& texts);

}  // namespace tchat

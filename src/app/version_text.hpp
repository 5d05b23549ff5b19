/// What this program is: version, commit, compiler and libraries.
#pragma once

#include <string>

namespace tchat {

/// "tchat 1.1.0", then lines for the commit, the compiler and the libraries with their versions.
std::string version_text();

}  // namespace tchat

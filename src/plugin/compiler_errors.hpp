/// What a C++ compiler says of a plugin, in a few lines: one mistake in a template gives a hundred of its own.
#pragma once

#include <string>

namespace tchat {

/// Every mistake once, at its place in the author's files (not in tchat's or the system's headers), with the line and,
/// where it is one that authors of problems often make, the cure. `include_folder` is the folder with
/// tchat/problem.hpp. Empty when the output (of g++ or clang++) names no error.
std::string short_errors(const std::string& output, const std::string& include_folder);

}  // namespace tchat

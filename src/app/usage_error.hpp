/// What is said of a command line that cannot be parsed.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace tchat {

/// One message: the command, what was found, near commands or options, where help is. `app` has been parsed in vain.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace tchat

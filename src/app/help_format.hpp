/// How help looks: at most 100 columns, words of this program.
#pragma once

#include <CLI/App.hpp>

namespace tchat {

/// For the program, before its commands are added: they inherit it.
void set_help_format(CLI::App& app);

}  // namespace tchat

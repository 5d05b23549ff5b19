/// NAME on the command line of commands that look for more than a plugin under that name.
#pragma once

#include <optional>
#include <string>

namespace tchat {

/// NAME.tch or NAME.cpp means the problem NAME with that plugin, unless -p names another one.
void take_source_as_problem(std::string& name, std::optional<std::string>& plugin);

}  // namespace tchat

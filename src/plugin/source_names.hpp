/// Names of parameters as a problem's source spells them. Nothing is compiled or loaded, so that whoever asks runs none
/// of the code in the folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// The parameters of the problem that a name or path stands for (plugin_build.hpp): statements `par NAME = ...` of
/// formulas, the list `parameter_names` of C++. Empty where the source has no names, or there is none.
std::vector<std::string> parameter_names_in_source(const std::string& name_or_path);

/// The strings of the first list `parameter_names[] = {"a", "b"}` of a C++ text outside of comments; empty
/// when it is not a list of plain strings.
std::vector<std::string> parameter_names_in_cpp(std::string_view text);

}  // namespace tchat

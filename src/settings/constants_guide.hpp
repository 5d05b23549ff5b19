/// Constants in words, for the screen: what there are, and what a given set of them asks for.
#pragma once

#include <string>

#include "settings/run_settings.hpp"

namespace tchat {

/// Every constant with its meaning, default and limits, in the order of the positional form.
std::string constants_guide();

/// The signature in words, then every constant with its value, meaning and limits.
std::string explained_text(const RunSettings& settings);

}  // namespace tchat

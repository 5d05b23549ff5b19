/// Suggestions for a word that is not known: "did you mean".
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// In capitals, where they are letters of ASCII.
std::string upper(std::string_view word);

/// Those of `known` that are spelled much like `word` or contain it, in any case, best first, at most five.
std::vector<std::string> near_words(std::string_view word, std::span<const std::string> known);

}  // namespace tchat

/// Numbers as Fortran programs write them, and the messages about tokens that are none.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// A finite number: `1.5`, `1.5E-03`, `1.5D-03`, `1.5E-101` and `1.5-101` (a three-digit exponent without its letter).
/// A number too small for a double is zero. Nothing for any other text, for inf, nan and numbers too large.
std::optional<double> parse_fortran_real(std::string_view text);

/// The blank-separated words of a line.
std::vector<std::string_view> split_words(std::string_view line);

/// `line` without a carriage return at its end.
std::string_view without_carriage_return(std::string_view line);

}  // namespace tchat

/// Numbers in texts: one reader for constants, files, formulas and the command line.
#pragma once

#include <optional>
#include <string_view>

namespace tchat {

/// The whole text as a finite number with exponent letter e, E, d or D: `1.5`, `+1.5E-03`, `1.5d-03`. Nothing
/// for any other text, for inf and nan, and for numbers out of the range of double.
std::optional<double> parse_real(std::string_view text);

/// As Fortran programs write them: `1.5E-101` may be `1.5-101`, a three-digit exponent without its letter; a number too
/// small for a double is zero.
std::optional<double> parse_fortran_real(std::string_view text);

/// The whole text as an integer; nothing for one whose negative is no int: signs are taken off everywhere.
std::optional<int> parse_integer(std::string_view text);

}  // namespace tchat

/// Tables for other programs: CSV as RFC 4180 has it but for the line ends, which are those of Unix, and JSON.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tchat {

/// One value; the first alternative is "not known".
using TableCell = std::variant<std::monostate, bool, int, double, std::string>;

/// As a CSV field: numbers with the digits from which they are read back exactly, truth as 1 or 0, infinity as inf or
/// -inf, text in quotes where it must be. Empty when not known or NaN.
std::string csv_field(const TableCell& cell);

/// As a JSON value: null when not known and for numbers that are not finite, which JSON does not have.
std::string json_value(const TableCell& cell);

/// Fields separated by commas, with a newline.
std::string csv_line(const std::vector<std::string>& fields);

/// The headings as they can stand in one table: one that is there already gets a number, "t" -> "t (2)".
std::vector<std::string> distinct_headings(const std::vector<std::string>& headings);

}  // namespace tchat

#include "files/table_format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "base/printable.hpp"

namespace tchat {

namespace {

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// Whatever bytes a name in a file has, the result is valid.
std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : printable(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? std::string("\\n") : std::string(1, static_cast<unsigned char>(c) < 0x80 ? c : '_');
  }
  return quoted + '"';
}

/// What follows for each alternative of a cell.
template <class... Functions>
struct Cases : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Cases(Functions...) -> Cases<Functions...>;

}  // namespace

std::string csv_field(const TableCell& cell) {
  return std::visit(
      Cases{[](std::monostate) { return std::string(); }, [](bool value) { return std::string(value ? "1" : "0"); },
            [](int value) { return fmt::format("{}", value); },
            [](double value) { return std::isnan(value) ? std::string() : fmt::format("{}", value); },
            [](const std::string& text) { return csv_text(text); }},
      cell);
}

std::string json_value(const TableCell& cell) {
  return std::visit(
      Cases{[](std::monostate) { return std::string("null"); },
            [](bool value) { return std::string(value ? "true" : "false"); },
            [](int value) { return fmt::format("{}", value); },
            [](double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string("null"); },
            [](const std::string& text) { return json_text(text); }},
      cell);
}

std::string csv_line(const std::vector<std::string>& fields) { return fmt::format("{}\n", fmt::join(fields, ",")); }

std::vector<std::string> distinct_headings(const std::vector<std::string>& headings) {
  std::set<std::string> taken;
  std::vector<std::string> distinct;
  for (const std::string& heading : headings) {
    std::string name = heading;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{} ({})", heading, k);
    distinct.push_back(name);
  }
  return distinct;
}

}  // namespace tchat

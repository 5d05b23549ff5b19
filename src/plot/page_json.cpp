#include "plot/page_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "files/table_format.hpp"
#include "plot/axis_scale.hpp"

namespace tchat {

namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD

unsigned char byte_at(std::string_view text, std::size_t k) { return static_cast<unsigned char>(text[k]); }

/// Bytes of the UTF-8 character that begins at `k`; 0 where none does. Overlong forms, surrogates and numbers beyond
/// U+10FFFF are none.
std::size_t character_length(std::string_view text, std::size_t k) {
  const unsigned char first = byte_at(text, k);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : (first & 0xF0) == 0xE0        ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || k + length > text.size()) return 0;
  for (std::size_t j = 1; j < length; ++j)
    if ((byte_at(text, k + j) & 0xC0) != 0x80) return 0;
  const unsigned char second = byte_at(text, k + 1);
  const bool is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_beyond = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return is_overlong || is_beyond ? 0 : length;
}

std::string escaped_byte(unsigned char c) {
  if (c < 0x20 || c == 0x7f) return " ";
  if (c == '"' || c == '\\') return std::string("\\") + static_cast<char>(c);
  if (c == '<' || c == '>' || c == '&') return fmt::format("\\u{:04x}", c);
  return std::string(1, static_cast<char>(c));
}

}  // namespace

std::string page_text(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = character_length(text, k);
    if (length == 0)
      quoted += replacement;
    else
      quoted += length == 1 ? escaped_byte(byte_at(text, k)) : std::string(text.substr(k, length));
    k += std::max<std::size_t>(length, 1);
  }
  return quoted + '"';
}

std::string page_label(const LabelText& text) {
  return text.markup ? page_object({{"t", page_text(text.text)}, {"m", "1"}})
                     : page_object({{"t", page_text(text.text)}});
}

std::string page_number(double value) { return can_be_shown(value) ? json_value(value) : "null"; }

std::string page_number(double value, int digits) {
  return can_be_shown(value) ? fmt::format("{:.{}g}", value, digits) : "null";
}

std::string page_list(const std::vector<std::string>& values) { return fmt::format("[{}]", fmt::join(values, ",")); }

std::string page_object(std::initializer_list<std::pair<std::string_view, std::string>> members) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : members) texts.push_back(fmt::format("\"{}\":{}", name, value));
  return fmt::format("{{{}}}", fmt::join(texts, ","));
}

}  // namespace tchat

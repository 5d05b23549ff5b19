#include "base/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "base/printable.hpp"

namespace tchat {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; }

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string shown = printable(text.substr(0, longest));
  std::replace(shown.begin(), shown.end(), '\n', '?');
  return fmt::format("'{}{}'", shown, text.size() > longest ? "..." : "");
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = 0;
  while (true) {
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    if (begin == line.size()) return words;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) ++end;
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_carriage_return(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string quoted_for_shell(const std::string& word) {
  const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./:,=@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace tchat

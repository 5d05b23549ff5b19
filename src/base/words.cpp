#include "base/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/messages.hpp"

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

namespace {

/// Least number of insertions, deletions and replacements that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string upper(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> near_words(std::string_view word, std::span<const std::string> known) {
  const std::string wanted = upper(word.substr(0, 32));
  std::vector<std::pair<std::size_t, std::string>> candidates;
  for (const std::string& each : known) {
    const std::string name = upper(each);
    const std::size_t distance = edit_distance(wanted, name);
    const bool part = wanted.size() > 2 && name.find(wanted) != std::string::npos;
    if (part || (distance <= 2 && distance < wanted.size())) candidates.emplace_back(distance, each);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (candidates.size() > 5) candidates.resize(5);
  std::vector<std::string> result;
  for (auto& [distance, name] : candidates) result.push_back(std::move(name));
  return result;
}

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_sign(char c) { return c == '+' || c == '-'; }
bool is_exponent_letter(char c) { return c == 'e' || c == 'E' || c == 'd' || c == 'D'; }

std::string_view take_digits(std::string_view& rest) {
  std::size_t count = 0;
  while (count < rest.size() && is_digit(rest[count])) ++count;
  const std::string_view digits = rest.substr(0, count);
  rest.remove_prefix(count);
  return digits;
}

/// The end of a mantissa and what follows it; false when the text does not begin with one.
bool take_mantissa(std::string_view& rest) {
  std::size_t digits = take_digits(rest).size();
  if (!rest.empty() && rest[0] == '.') {
    rest.remove_prefix(1);
    digits += take_digits(rest).size();
  }
  return digits > 0;
}

/// What follows a mantissa; where Fortran's form is allowed the letter may be missing, and the sign must then be there.
bool take_exponent(std::string_view rest, bool fortran, std::string_view& exponent) {
  const bool letter = !rest.empty() && is_exponent_letter(rest[0]);
  if (letter) rest.remove_prefix(1);
  exponent = rest;
  const bool sign = !rest.empty() && is_sign(rest[0]);
  if (sign) rest.remove_prefix(1);
  return (letter || (sign && fortran)) && !take_digits(rest).empty() && rest.empty();
}

/// A finite number as std::from_chars takes it; nothing where there is more to look at.
std::optional<double> parse_usual(std::string_view text) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && stop == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<double> parse(std::string_view text, bool fortran) {
  constexpr std::size_t longest = 400;
  if (text.size() > longest) return std::nullopt;
  if (const auto value = parse_usual(text)) return value;
  std::string_view rest = text;
  if (!rest.empty() && is_sign(rest[0])) rest.remove_prefix(1);
  if (!text.empty() && text[0] == '+') text = rest;  // std::from_chars takes no plus
  if (!take_mantissa(rest)) return std::nullopt;

  std::array<char, longest + 2> normal;  // the number with exponent letter e, as std::from_chars reads it
  const std::size_t mantissa = text.size() - rest.size();
  char* end = text.substr(0, mantissa).copy(normal.data(), mantissa) + normal.data();
  if (!rest.empty()) {
    std::string_view exponent;
    if (!take_exponent(rest, fortran, exponent)) return std::nullopt;
    *end++ = 'e';
    end += exponent.copy(end, exponent.size());
  }
  double value = 0.0;
  const auto [stop, error] = std::from_chars(normal.data(), end, value);
  if (error == std::errc::result_out_of_range) {
    const std::string_view number(normal.data(), static_cast<std::size_t>(end - normal.data()));
    if (fortran && number.find("e-") != std::string_view::npos) return 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Without a leading plus sign, which std::from_chars does not take. A second sign is no number.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && !is_sign(text[1])) text.remove_prefix(1);
  return text;
}

}  // namespace

std::optional<double> parse_real(std::string_view text) { return parse(text, false); }
std::optional<double> parse_fortran_real(std::string_view text) { return parse(text, true); }

std::optional<int> parse_integer(std::string_view text) {
  text = without_plus(text);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (value == std::numeric_limits<int>::min()) return std::nullopt;
  return value;
}

Command words_of(std::initializer_list<Command> parts) {
  Command all;
  for (const Command& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::string shell_words(const Command& words) {
  std::string text;
  for (const std::string& word : words) text += " " + quoted_for_shell(word);
  return text;
}

std::string shell_line(const Command& command) { return "tchat" + shell_words(command); }

std::string shell_line(const Commands& commands) {
  std::string text;
  for (const Command& command : commands) text += (text.empty() ? "" : " && ") + shell_line(command);
  return text;
}

}  // namespace tchat

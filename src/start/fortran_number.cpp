#include "start/fortran_number.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace tchat {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_sign(char c) { return c == '+' || c == '-'; }
bool is_exponent_letter(char c) { return c == 'e' || c == 'E' || c == 'd' || c == 'D'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; }

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

/// An exponent with or without its letter; without one the sign must be there.
bool take_exponent(std::string_view rest, std::string_view& exponent) {
  const bool letter = !rest.empty() && is_exponent_letter(rest[0]);
  if (letter) rest.remove_prefix(1);
  exponent = rest;
  const bool sign = !rest.empty() && is_sign(rest[0]);
  if (sign) rest.remove_prefix(1);
  return (letter || sign) && !take_digits(rest).empty() && rest.empty();
}

}  // namespace

std::optional<double> parse_fortran_real(std::string_view text) {
  constexpr std::size_t longest = 400;
  if (text.size() > longest) return std::nullopt;
  std::string_view rest = text;
  if (!rest.empty() && is_sign(rest[0])) rest.remove_prefix(1);
  if (!text.empty() && text[0] == '+') text = rest;  // std::from_chars takes no plus
  if (!take_mantissa(rest)) return std::nullopt;

  std::array<char, longest + 2> normal{};  // the number with exponent letter e, as std::from_chars reads it
  const std::size_t mantissa = text.size() - rest.size();
  char* end = text.substr(0, mantissa).copy(normal.data(), mantissa) + normal.data();
  if (!rest.empty()) {
    std::string_view exponent;
    if (!take_exponent(rest, exponent)) return std::nullopt;
    *end++ = 'e';
    end += exponent.copy(end, exponent.size());
  }
  double value = 0.0;
  const auto [stop, error] = std::from_chars(normal.data(), end, value);
  if (error == std::errc::result_out_of_range) {
    const std::string_view number(normal.data(), static_cast<std::size_t>(end - normal.data()));
    if (number.find("e-") != std::string_view::npos) return 0.0;
    return std::nullopt;
  }
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
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

std::string_view without_carriage_return(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

}  // namespace tchat

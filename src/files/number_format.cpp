#include "files/number_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tchat {

namespace {

constexpr int largest_point = 9999;
constexpr double largest_es = 1.7976e308;  ///< rounded up in its last decimal a larger one is read as infinity

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }  // of UTF-8

/// Right-justified in `width` columns, three exponent digits at least.
void append_exponential(std::string& line, double value, int decimals, std::size_t width) {
  fmt::memory_buffer digits;
  fmt::format_to(std::back_inserter(digits), "{:.{}E}", finite(value), decimals);
  const std::string_view text(digits.data(), digits.size());
  const auto exponent = text.find('E') + 2;  // after the sign
  const bool short_exponent = text.size() - exponent == 2;
  line.append(width - text.size() - (short_exponent ? 1 : 0), ' ');
  line.append(text.substr(0, exponent));
  if (short_exponent) line += '0';
  line.append(text.substr(exponent));
}

}  // namespace

double finite(double value) {
  if (std::isnan(value)) return capped_value;
  if (std::isinf(value)) return std::copysign(capped_value, value);
  return std::isnormal(value) ? value : 0.0;
}

void append_e19(std::string& line, double value) { append_exponential(line, value, 10, 19); }

void append_e26(std::string& line, double value) { append_exponential(line, value, 16, 26); }

std::string e19(double value) {
  std::string text;
  append_e19(text, value);
  return text;
}

std::string es(double value, int width, int decimals) {
  const double bounded = std::clamp(finite(value), -largest_es, largest_es);
  std::string text = fmt::format("{:.{}E}", bounded, decimals);
  const auto letter = text.find('E');
  if (text.size() - letter > 4) text.erase(letter, 1);  // a three-digit exponent takes the letter's place
  return fmt::format("{:>{}}", text, width);
}

std::string integer_field(int value, int width) { return fmt::format(" {:>{}}", value, width - 1); }

int wrapped_point(int point) { return point < 1 ? point : (point - 1) % largest_point + 1; }

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (continues_character(c)) continue;
    const bool printable = c >= ' ' && c <= '~' && c != '\'' && c != '"';
    plain += printable ? c : '_';
  }
  return plain;
}

std::string heading_field(std::string_view name, int width) {
  const std::string cut = plain_name(name).substr(0, static_cast<std::size_t>(width - 2));
  return fmt::format("{:>{}}  ", cut, width - 2);
}

}  // namespace tchat

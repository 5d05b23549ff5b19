#include "files/auto_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace tchat {

namespace {

constexpr int largest_point = 9999;
constexpr double smallest = 2.2251e-308;    ///< rounded in its last decimal a smaller one may be subnormal
constexpr std::size_t longest_number = 40;  ///< with at most 16 decimals and three digits of exponent
constexpr double largest_es = 1.7976e308;   ///< rounded up in its last decimal a larger one is read as infinity

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }  // of UTF-8

/// As C prints it with %.*E: `-1.2345E-07`. Neither the locale nor the heap is asked.
std::string_view scientific(double value, int decimals, std::array<char, longest_number>& digits) {
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::scientific, decimals);
  const std::string_view text(digits.data(), static_cast<std::size_t>(end - digits.data()));
  if (error == std::errc()) digits[text.find('e')] = 'E';
  return text;
}

/// Right-justified in `width` columns, three exponent digits at least.
void append_exponential(std::string& line, double value, int decimals, std::size_t width) {
  std::array<char, longest_number> digits;
  const std::string_view text = scientific(finite(value), decimals, digits);
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
  return std::abs(value) > smallest ? value : 0.0;
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
  std::array<char, longest_number> digits;
  std::string text(scientific(bounded, decimals, digits));
  const auto letter = text.find('E');
  if (text.size() - letter > 4) text.erase(letter, 1);  // a three-digit exponent takes the letter's place
  return fmt::format("{:>{}}", text, width);
}

void append_short(std::string& line, double value, int digits) {
  std::array<char, longest_number> text;
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), finite(value), std::chars_format::general, digits);
  line.append(text.data(), end);
}

void append_scientific(std::string& line, double value, int decimals) {
  std::array<char, longest_number> digits;
  line.append(scientific(finite(value), decimals, digits));
}

std::string integer_field(int value, int width) {
  std::string text;
  append_integer_field(text, value, width);
  return text;
}

void append_integer_field(std::string& line, int value, int width) {
  std::array<char, longest_number> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  const std::ptrdiff_t length = end - digits.data();
  line.append(static_cast<std::size_t>(std::max<std::ptrdiff_t>(width - length, 1)), ' ');
  line.append(digits.data(), end);
}

void append_branch_and_point(std::string& line, int branch, int point, int sign) {
  const std::size_t begin = line.size();
  append_integer_field(line, branch, 5);
  line.erase(begin, 1);  // no column stands before it
  append_integer_field(line, sign * wrapped_point(point), 6);
}

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

namespace fs = std::filesystem;

std::string constants_file_of(const std::string& name) {
  const fs::path path(name);
  return (path.parent_path() / fs::path(constants_prefix).concat(path.filename().string())).string();
}

std::string sibling_path(const std::string& path, char letter) {
  const fs::path given(path);
  const std::string name = given.filename().string();
  const auto beside = [&given](const std::string& other) { return (given.parent_path() / other).string(); };
  if (name == "fort.7" || name == "fort.8" || name == "fort.9")
    return beside(letter == 'p' ? "fort.7" : letter == 'q' ? "fort.8" : letter == 'd' ? "fort.9" : "fort.2");
  if (name.size() < 3 || name[1] != '.') return "";
  const std::string rest = name.substr(1);
  const std::string ours = beside(letter + rest);
  std::error_code error;
  if (fs::is_regular_file(ours, error) || std::string("pqd").find(name[0]) != std::string::npos) return ours;
  if (letter == 'd' || letter == 'r') return ours;
  if (std::string("bs").find(name[0]) != std::string::npos) return beside((letter == 'p' ? "b" : "s") + rest);
  return "";
}

std::string resolve_run_file(const std::string& path, char letter) {
  const fs::path given(path);
  const fs::path prefixed = given.parent_path() / (std::string{letter, '.'} + given.filename().string());
  std::error_code error;
  return !fs::exists(given, error) && fs::exists(prefixed, error) ? prefixed.string() : path;
}

std::string run_name(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  const bool prefixed = name.size() > 2 && name[1] == '.' && std::string("pqdbs").find(name[0]) != std::string::npos;
  return prefixed ? name.substr(2) : name;
}

std::string run_path(const std::string& path) {
  return (std::filesystem::path(path).parent_path() / run_name(path)).string();
}

}  // namespace tchat

#include "constants/constant_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "constants/printable.hpp"
#include "constants/user_error.hpp"

namespace tchat {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Without a leading plus sign, which std::from_chars does not take. A second sign is no number.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

/// Only the characters of a decimal number, at least one digit: keeps "inf", "nan" and hexadecimal out.
bool looks_decimal(std::string_view text) {
  const auto allowed = [](char c) {
    return is_digit(c) || std::string_view("+-.eEdD").find(c) != std::string_view::npos;
  };
  return std::all_of(text.begin(), text.end(), allowed) && std::any_of(text.begin(), text.end(), is_digit);
}

std::string example_text(const Constant& constant, const Place& place) {
  if (!place.positional || constant.record < 1) return fmt::format("{} = {}", constant.keyword, constant.example);
  const PositionalRecord& record = positional_records()[static_cast<std::size_t>(constant.record - 1)];
  return fmt::format("{} ({})", record.example, record.layout);
}

}  // namespace

std::string Place::text() const { return line > 0 ? fmt::format("{}:{}", source, line) : source; }

RawValue RawValue::scalar(Token token) {
  RawValue value;
  value.token = std::move(token);
  return value;
}

RawValue RawValue::list(const std::vector<Token>& tokens, Place place) {
  RawValue value;
  value.shape = Shape::list;
  value.token.place = std::move(place);
  for (const Token& token : tokens) value.items.push_back(scalar(token));
  return value;
}

std::optional<int> parse_integer(std::string_view text) {
  text = without_plus(text);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (value == std::numeric_limits<int>::min()) return std::nullopt;
  return value;
}

std::optional<double> parse_real(std::string_view text) {
  text = without_plus(text);
  if (!looks_decimal(text)) return std::nullopt;
  std::string copy(text);
  std::replace_if(
      copy.begin(), copy.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  double value = 0.0;
  const auto [end, error] = std::from_chars(copy.data(), copy.data() + copy.size(), value);
  if (error != std::errc() || end != copy.data() + copy.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string shown = printable(text.substr(0, longest));
  std::replace(shown.begin(), shown.end(), '\n', '?');
  return fmt::format("'{}{}'", shown, text.size() > longest ? "..." : "");
}

void refuse(const Constant& constant, const std::string& name, const Place& place, const std::string& found,
            const std::string& allowed) {
  throw UserError(fmt::format("{}: {} ({}): found {}; allowed: {}; for example: {}", place.text(), name,
                              constant.meaning, found, allowed.empty() ? allowed_text(constant) : allowed,
                              example_text(constant, place)));
}

int integer_value(const Constant& constant, const std::string& name, const RawValue& value, const Limits& limits) {
  const auto number = value.shape == RawValue::Shape::scalar ? parse_integer(value.token.text) : std::optional<int>();
  if (number && limits.contain(*number)) return *number;
  const bool described = &limits == &constant.limits;
  refuse(constant, name, value.token.place, in_quotes(value.token.text), described ? "" : limits_text(limits, false));
}

double real_value(const Constant& constant, const std::string& name, const RawValue& value, const Limits& limits) {
  const auto number = value.shape == RawValue::Shape::scalar ? parse_real(value.token.text) : std::optional<double>();
  if (number && limits.contain(*number)) return *number;
  refuse(constant, name, value.token.place, in_quotes(value.token.text));
}

std::optional<StartLabel> parse_typed_label(std::string_view text) {
  if (text.size() >= 2 && (text.front() == '\'' || text.front() == '"') && text.back() == text.front())
    text = text.substr(1, text.size() - 2);
  if (text.size() < 3 || !is_digit(text[2])) return std::nullopt;
  StartLabel label;
  for (const char c : text.substr(0, 2)) label.type += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const auto types = point_type_names();
  const auto count = parse_integer(text.substr(2));
  if (std::find(types.begin(), types.end(), label.type) == types.end() || !count || *count < 1) return std::nullopt;
  label.number = *count;
  return label;
}

}  // namespace tchat

#include "settings/constant_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "settings/point_type.hpp"

namespace tchat {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

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
  for (const std::size_t letters : {3U, 2U}) {  // R1 and LPD are types
    if (text.size() <= letters) continue;
    StartLabel label;
    for (const char c : text.substr(0, letters))
      label.type += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    const auto count = parse_integer(text.substr(letters));
    if (find_point_type(label.type) == nullptr || !is_digit(text[letters]) || !count || *count < 1) continue;
    label.number = *count;
    return label;
  }
  return std::nullopt;
}

}  // namespace tchat

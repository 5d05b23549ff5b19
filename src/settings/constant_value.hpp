/// Values of constants as they stand in a text, before they are known to be right: tokens with their places, and the
/// conversions to numbers. Every conversion throws UserError with the complete message
///
///     path:line: CONSTANT (meaning): found 'token'; allowed: ...; for example: ...
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "settings/constants_table.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

struct Token {
  std::string text;
  Place place;
};

struct RawPair;

/// A value in any of its shapes: one token; a list; or pairs (index: value or list of values).
struct RawValue {
  enum class Shape { scalar, list, pairs };
  Shape shape = Shape::scalar;
  Token token;  ///< the scalar; for the other shapes the text of the whole
  std::vector<RawValue> items;
  std::vector<RawPair> pairs;

  static RawValue scalar(Token token);
  static RawValue list(const std::vector<Token>& tokens, Place place);
};

struct RawPair {
  Token index;
  RawValue value;
};

/// "CONSTANT (meaning): found ...; allowed: ...; for example: ..." with its place, thrown as UserError. `name` is the
/// constant or one of its values ("ICP(2)"), `found` complete with quotes; empty `allowed`: as the table says.
[[noreturn]] void refuse(const Constant& constant, const std::string& name, const Place& place,
                         const std::string& found, const std::string& allowed = "");

int integer_value(const Constant& constant, const std::string& name, const RawValue& value, const Limits& limits);
double real_value(const Constant& constant, const std::string& name, const RawValue& value, const Limits& limits);

/// "PD1" -> type "PD", number 1, in any case and with or without quotes; nothing for other text.
std::optional<StartLabel> parse_typed_label(std::string_view text);

}  // namespace tchat

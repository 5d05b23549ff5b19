/// The text `KEY = value`: scalars, lists `[1, 61]` (brackets may be left out), nested lists, pairs `{61: 0.0}`,
/// quotes, comments after #, several on a line with commas between. Syntax only; no constant is looked up here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "settings/constant_value.hpp"

namespace tchat {

/// KEY = value or KEY(argument) = value.
struct Assignment {
  Token key;
  std::string argument;
  bool has_argument = false;
  RawValue value;
};

/// All assignments of a text that begins at `start`. Throws UserError on bad syntax.
std::vector<Assignment> parse_assignments(std::string_view text, const Place& start);

/// True when a text begins with `KEY =` or `KEY(argument) =`.
bool begins_with_assignment(std::string_view text);

/// The constant of an assignment. Throws UserError that lists near keywords when there is none.
const Constant& constant_of(const Assignment& assignment);

}  // namespace tchat

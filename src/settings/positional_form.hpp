/// The positional form: records of values, list-directed, in the order of the table.
///
/// Values are separated by blanks, one comma or newlines; `r*v` stands for r times v; when a record has its values the
/// rest of the line is commentary; the next record begins on the next line that is not blank. Null values (two commas,
/// `r*` without a value) and `/` are refused. After the last record: `KEY = value` lines of extension constants,
/// comments (#), and other text, which is ignored with a warning unless it begins with a number or a keyword.
#pragma once

#include <string_view>

#include "settings/settings_draft.hpp"

namespace tchat {

/// Reads a whole text into a draft. `source` is the file's name in messages. Throws UserError.
void read_positional_form(std::string_view text, const std::string& source, SettingsDraft& draft, Warnings* warnings);

}  // namespace tchat

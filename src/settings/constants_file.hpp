/// Constants files in either form, and the reader of the positional one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "settings/run_settings.hpp"
#include "settings/settings_draft.hpp"

namespace tchat {

// The positional form: records of values, list-directed, in the order of the table.
//
// Values are separated by blanks, one comma or newlines; `r*v` stands for r times v; when a record has its values the
// rest of the line is commentary; the next record begins on the next line that is not blank. Null values (two commas,
// `r*` without a value) and `/` are refused. After the last record: `KEY = value` lines of extension constants,
// comments (#), and other text, which is ignored with a warning unless it begins with a number or a keyword.

/// Reads a whole text into a draft. `source` is the file's name in messages. Throws UserError.
void read_positional_form(std::string_view text, const std::string& source, SettingsDraft& draft, Warnings* warnings);

// Constants files gc.NAME: reading either form and KEY=VALUE overrides into checked RunSettings.
//
// The first non-blank character tells the form: a digit, a sign or a point begins the positional form
// (read_positional_form()), anything else `KEY = value` lines with defaults (keyword_form.hpp). CRLF and a missing
// final newline are fine. All functions throw UserError: place, constant, meaning, what was found, what is allowed,
// example.

/// `warnings`, if not null, receives sentences about what is accepted without effect. Names of parameters are kept as
/// they are (RunSettings::names) until resolve_names().
RunSettings read_constants_file(const std::string& path, Warnings* warnings = nullptr);

enum class ConstantsForm { positional, keyword };

/// The form of a file that can be read. Throws UserError when it is empty or cannot be read.
ConstantsForm constants_form(const std::string& path);

/// The same from memory; `name` stands for the path in messages.
RunSettings read_constants_text(std::string_view text, const std::string& name, Warnings* warnings = nullptr);

/// Overrides of the command line, all together: KEY=VALUE with any constant (a list replaces the whole list, its count
/// follows), PAR(2)=0.8, PAR(omega)=0.8. The later of two for one constant wins. What ties constants together is
/// checked when all are in place, so that a new signature can come as GCFIND=.. GCHIND=.. GCGIND=.. in any order.
/// Settings are unchanged when it throws.
void apply_overrides(RunSettings& settings, std::span<const std::string> key_values, Warnings* warnings = nullptr);

/// Is the constant among what the overrides set?
bool is_overridden(std::span<const std::string> key_values, std::string_view keyword);

}  // namespace tchat

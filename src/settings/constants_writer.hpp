/// Constants as text: files in either form, values, and explanations for the screen.
#pragma once

#include <string>

#include "settings/constants_table.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// Settings as text: a constants file in either form, the values of one constant, the table for documentation.
//
// Numbers have the fewest digits that read back to the same bits. PAR values of the command line are no constants and
// are not written (they are in the q-file of the run).

/// The positional form (r.NAME): each record with the names of its values as commentary, then all extension constants
/// as `KEY = value` lines.
std::string positional_text(const RunSettings& settings);

/// The keyword form: one constant on each line, explained by a comment.
std::string keyword_text(const RunSettings& settings);

/// The value in keyword form: "50", "[1, 61]", "{1: [2.5, 3], -2: 4}". Empty for counts, which follow from lists.
std::string value_text(const Constant& constant, const RunSettings& settings);

/// The value that a keyword file without this constant has; empty when there is none.
std::string default_text(const Constant& constant);

// Constants in words, for the screen: what there are, and what a given set of them asks for.

/// Every constant with its meaning, default and limits, in the order of the positional form.
std::string constants_guide();

/// The signature in words, then every constant with its value, meaning and limits.
std::string explained_text(const RunSettings& settings);

}  // namespace tchat

/// How much work a function of formulas is: each call of it computes anew what it uses, so that functions which call
/// others twice double the work at every level.
#pragma once

#include "plugin/formula_errors.hpp"
#include "plugin/formula_file.hpp"
#include "plugin/name_table.hpp"

namespace tchat::formulas {

/// Adds a mistake for each function whose value takes more than 100,000 operations, counting those of the functions and
/// definitions that it uses. Nothing may be defined by itself (DependenceTable finds that).
void refuse_expensive_functions(const FormulaFile& file, const NameTable& names, FormulaErrors& errors);

}  // namespace tchat::formulas

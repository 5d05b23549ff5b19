/// The value of an expression that has no names.
#pragma once

#include "plugin/expression.hpp"

namespace tchat::formulas {

/// Of numbers, pi and built-in functions. Throws FormulaError for any other name, for conditions, and when the value is
/// not finite; `role` says whose value it is.
double constant_value(const Expression& expression, const std::string& role);

}  // namespace tchat::formulas

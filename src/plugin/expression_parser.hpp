/// Expressions by precedence climbing. From loose to tight:
///
///     or,  and,  not,  comparisons (not chained),  + -,  * /,  unary -,  ^ (from the right: a^b^c is a^(b^c))
///
/// so that -x^2 is -(x^2), and 2^-x is allowed.
#pragma once

#include "plugin/expression.hpp"
#include "plugin/tokens.hpp"

namespace tchat::formulas {

/// Reads the longest expression from here on. Throws FormulaError where there is none, a parenthesis is missing, or it
/// is longer than a compiler should be asked to take.
Expression parse_expression(TokenReader& in);

}  // namespace tchat::formulas

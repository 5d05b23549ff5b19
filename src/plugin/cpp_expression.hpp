/// Expressions as C++.
#pragma once

#include <functional>
#include <string>

#include "plugin/expression.hpp"

namespace tchat::formulas {

/// The text of an expression; `name_of` gives the C++ name of a name, `call_of` what stands before the arguments of a
/// user's function, "f<T>(state, par, " ("" for functions that are built in). Every number is a double: 1/2 is 0.5.
std::string cpp_expression(const Expression& expression, const std::function<std::string(const std::string&)>& name_of,
                           const std::function<std::string(const std::string&)>& call_of);

/// A double that is read back exactly, never an integer.
std::string cpp_number(double value);

}  // namespace tchat::formulas

/// Expressions in files of formulas: syntax tree, functions, parser, values, and the same expressions in C++.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/tokens.hpp"

namespace tchat::formulas {

/// One node; its operands are given by their places in Expression::nodes, always before its own.
struct Node {
  enum class Kind {
    number,
    name,
    call,        ///< text(operands...)
    negation,    ///< -a
    arithmetic,  ///< a text b, with text one of + - * / ^
    comparison,  ///< a text b, with text one of < > <= >= == !=
    logic,       ///< a text b, with text "and" or "or"
    inversion    ///< not a
  };
  Kind kind = Kind::number;
  std::string text;
  double number = 0.0;
  std::vector<int> operands;
  Position at;

  bool is_condition() const { return kind == Kind::comparison || kind == Kind::logic || kind == Kind::inversion; }
};

struct Expression {
  std::vector<Node> nodes;  ///< the last one is the root

  const Node& node(int place) const { return nodes[static_cast<std::size_t>(place)]; }
  int root() const { return static_cast<int>(nodes.size()) - 1; }
  Position at;  ///< where it begins
};

// The functions that formulas may call.

struct BuiltInFunction {
  /// How it behaves where its argument is a state that moves.
  enum class Nature { smooth, kinked, stepped };
  const char* name;
  int arguments;
  Nature nature;
  const char* cpp;                   ///< its name in C++
  double (*of_one)(double);          ///< null when it has two arguments
  double (*of_two)(double, double);  ///< null when it has one
};

/// Null when there is none of that name.
const BuiltInFunction* find_function(std::string_view name);

std::vector<std::string> function_names();

// Expressions by precedence climbing. From loose to tight:
//
//     or,  and,  not,  comparisons (not chained),  + -,  * /,  unary -,  ^ (from the right: a^b^c is a^(b^c))
//
// so that -x^2 is -(x^2), and 2^-x is allowed.

/// Reads the longest expression from here on. Throws FormulaError where there is none, a parenthesis is missing, or it
/// is longer than a compiler should be asked to take.
Expression parse_expression(TokenReader& in);

// The value of an expression that has no names.

/// Of numbers, pi and built-in functions. Throws FormulaError for any other name, for conditions, and when the value is
/// not finite; `role` says whose value it is.
double constant_value(const Expression& expression, const std::string& role);

// Names of the user's as names of C++.

/// Gives every name one of C++: itself where that is possible, else with underscores behind it (keywords, macros of the
/// standard headers, names that the translation uses itself).
class CppNames {
 public:
  /// A name that nothing else has.
  std::string unique(const std::string& name);

 private:
  std::set<std::string> used_;
};

/// The text of an expression; `name_of` gives the C++ name of a name, `call_of` what stands before the arguments of a
/// user's function, "f<T>(state, par, " ("" for functions that are built in). Every number is a double: 1/2 is 0.5.
std::string cpp_expression(const Expression& expression, const std::function<std::string(const std::string&)>& name_of,
                           const std::function<std::string(const std::string&)>& call_of);

/// A double that is read back exactly, never an integer.
std::string cpp_number(double value);

}  // namespace tchat::formulas

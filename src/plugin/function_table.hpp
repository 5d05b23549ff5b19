/// The functions that formulas may call.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat::formulas {

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

}  // namespace tchat::formulas

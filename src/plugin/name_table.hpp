/// What each name of a file of formulas stands for.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "plugin/formula_file.hpp"

namespace tchat::formulas {

struct Symbol {
  enum class Kind { state, parameter, definition, function };
  Kind kind = Kind::state;
  std::size_t index = 0;  ///< among its kind; states in the order of their first equations
  Position at;
};

/// "a state", "a parameter", ...
std::string in_words(Symbol::Kind kind);

/// The names that expressions may use. Fields, events and jumps have names of their own.
class NameTable {
 public:
  /// Names used twice, or those of built-in functions and words, are mistakes.
  NameTable(const FormulaFile& file, FormulaErrors& errors);

  /// Null when the name stands for nothing.
  const Symbol* find(std::string_view name) const;
  const std::vector<std::string>& states() const { return states_; }
  /// All of them, with built-in functions and pi, for suggestions.
  std::vector<std::string> all() const;

 private:
  void add(const Token& name, Symbol::Kind kind, std::size_t index, FormulaErrors& errors);
  void add_states(const std::vector<Assignment>& equations, FormulaErrors& errors);

  std::map<std::string, Symbol, std::less<>> symbols_;
  std::vector<std::string> states_;
};

/// Throws FormulaError for a name that means something in every file: pi, a function, a word of conditions.
void refuse_reserved(const Token& name);

}  // namespace tchat::formulas

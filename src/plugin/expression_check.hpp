/// Whether the names of an expression are known and its parts are numbers or conditions where they must be.
#pragma once

#include <vector>

#include "plugin/formula_errors.hpp"
#include "plugin/formula_file.hpp"
#include "plugin/name_table.hpp"

namespace tchat::formulas {

/// Adds what is wrong to `errors`; file, names and errors outlive this object.
class ExpressionCheck {
 public:
  ExpressionCheck(const FormulaFile& file, const NameTable& names, FormulaErrors& errors)
      : file_(file), names_(names), errors_(errors) {}

  /// An expression that stands for a number; `arguments` are the names of those of its function.
  void value(const Expression& expression, const std::vector<Token>& arguments = {}) const;
  /// One that stands behind 'if'.
  void condition(const Expression& expression) const;

 private:
  void check(const Expression& expression, const std::vector<Token>& arguments) const;
  void check_node(const Expression& expression, const Node& node, const std::vector<Token>& arguments) const;
  void check_name(const Node& node, const std::vector<Token>& arguments) const;
  void check_call(const Node& node) const;
  [[noreturn]] void refuse_unknown(const Node& node) const;

  const FormulaFile& file_;
  const NameTable& names_;
  FormulaErrors& errors_;
};

}  // namespace tchat::formulas

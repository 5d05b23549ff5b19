/// Expressions over columns, as in -y '1/omega': gnuplot's own, with the names of columns in them.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "plot/label_text.hpp"

namespace tchat {

/// An expression taken apart. The formula is made of what is known to be harmless: it runs no command of gnuplot.
struct ColumnExpression {
  std::vector<std::string> names;  ///< of the columns, each once
  std::string formula;             ///< gnuplot's, with c1, c2, ... for the names and real numbers (1/2 is a half)

  bool is_one_name() const { return formula == "c1"; }
};

/// What the parser is told of names, which may have blanks and signs in them (L2-NORM).
struct KnownNames {
  std::function<std::size_t(std::string_view)> length;  ///< of the longest name that the text begins with; 0: none
  std::string list;                                     ///< for messages
};

/// Equal but for capitals.
bool same_letters(std::string_view a, std::string_view b);

/// Length of the longest of these names that the text begins with and that ends there, in any case; 0: none does.
std::size_t length_of_name(std::string_view text, const std::vector<std::string>& names);

/// Is there anything in it that a name would not have?
bool looks_like_expression(std::string_view text);

/// Throws UserError, beginning with `where`, for words that are neither names nor functions of gnuplot, for signs that
/// no expression has, and when there is no name at all.
ColumnExpression parse_expression(std::string_view text, const KnownNames& known, const std::string& where);

/// The expression for an axis; `label` gives the text of a name.
LabelText expression_label(std::string_view text, const KnownNames& known,
                           const std::function<LabelText(const std::string&)>& label);

/// The formula for every row of values of c1, c2, ..., by gnuplot; NaN where it has no real value. Throws UserError,
/// beginning with `where`, when gnuplot does not understand it or is missing.
std::vector<double> evaluate(const ColumnExpression& expression, const std::vector<std::vector<double>>& rows,
                             const std::string& where);

}  // namespace tchat

/// The words of a file of formulas: names, numbers and symbols, each with its place.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plugin/formula_errors.hpp"

namespace tchat::formulas {

struct Token {
  enum class Kind { name, number, symbol, end };
  Kind kind = Kind::end;
  std::string text;  ///< as written; powers are "^" in either form; of the end: ""
  double number = 0.0;
  Position at;

  bool is_name() const { return kind == Kind::name; }
  bool is_end() const { return kind == Kind::end; }
  /// The symbol or word `what`.
  bool is(std::string_view what) const { return kind != Kind::number && kind != Kind::end && text == what; }
};

/// A statement is a line, with the following one when it ends in a backslash; its last token is the end.
using Statement = std::vector<Token>;

/// All statements that are not empty; '#' begins a comment. A line that holds a character or number that cannot be is
/// told and left out.
std::vector<Statement> read_statements(std::string_view text, FormulaErrors& errors);

/// Reads a statement from its first token on.
class TokenReader {
 public:
  explicit TokenReader(const Statement& tokens) : tokens_(tokens) {}

  /// The token `ahead` places on; beyond the last one, the end.
  const Token& peek(std::size_t ahead = 0) const { return tokens_[std::min(at_ + ahead, tokens_.size() - 1)]; }
  const Token& next();
  /// Takes the token if it is `what`.
  bool accept(std::string_view what);
  /// Takes `what`, or throws FormulaError with `cure`: what should be written, beginning a clause.
  void expect(std::string_view what, const std::string& cure);
  /// Takes a name, or throws FormulaError; `role` says whose name.
  const Token& expect_name(const std::string& role);
  /// Throws FormulaError unless the statement is at its end.
  void expect_end() const;

 private:
  /// What to write where two numbers stand beside a comma, or two operands side by side; "" elsewhere.
  std::string hint() const;
  const Statement& tokens_;
  std::size_t at_ = 0;
};

/// "'x'", or "the end of the line".
std::string shown(const Token& token);

}  // namespace tchat::formulas

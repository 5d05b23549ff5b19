/// The tokens of a file of formulas, and the errors in it with their places.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat::formulas {

// What is wrong in a file of formulas, with its place.

/// A place in the text, both counted from 1; line 0 is the file as a whole.
struct Position {
  int line = 1;
  int column = 1;
};

/// One mistake: what was found and its cure, in one sentence. Thrown while a statement is read, collected in between.
struct FormulaError {
  Position at;
  std::string message;
};

/// The mistakes of one file, so that a user sees them all at once.
class FormulaErrors {
 public:
  void add(FormulaError error) { errors_.push_back(std::move(error)); }
  void add(Position at, std::string message) { errors_.push_back({at, std::move(message)}); }
  bool empty() const { return errors_.empty(); }

  /// Throws UserError with the first ten in the order of the text, each with its line and a mark below it, if there is
  /// any. `path` is how the file is called in messages.
  void throw_if_any(const std::string& path, std::string_view text) const;

 private:
  std::vector<FormulaError> errors_;
};

/// Calls work(); a FormulaError that it throws is collected.
template <class Work>
void collecting(FormulaErrors& errors, Work&& work) {
  try {
    work();
  } catch (FormulaError& error) {
    errors.add(std::move(error));
  }
}

/// " (did you mean 'omega'?)" for a word that is not known, "" when nothing is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

// The words of a file of formulas: names, numbers and symbols, each with its place.

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

/// What is wrong in a file of formulas, with its place.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tchat::formulas {

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

}  // namespace tchat::formulas

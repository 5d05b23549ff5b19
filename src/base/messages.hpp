/// Messages on the terminal: printable text, errors of the user, warnings, folded lines and progress.
#pragma once

#include <chrono>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tchat {

/// The text with '?' in the place of control characters other than newlines: names and words of files reach messages,
/// and must not reach the terminal as commands.
std::string printable(std::string_view text);

// The one exception of tchat's edges: something the user gave is wrong. Caught once, in main; exit status 2.

/// what() is the whole message: file and line where there is one, what was found, what is allowed, the cure. Printable:
/// words of files may hold any byte, and a zero byte would end the message.
class UserError : public std::runtime_error {
 public:
  explicit UserError(const std::string& message) : std::runtime_error(printable(message)) {}
};

/// The input was good but the computation failed (no convergence at the first point, disk full); exit status 1.
class ComputationError : public std::runtime_error {
 public:
  explicit ComputationError(const std::string& message) : std::runtime_error(printable(message)) {}
};

/// Exit status of a command at a label where what was asked for does not begin.
inline constexpr int nothing_begins_status = 4;

/// What was to be followed does not exist there, as a curve that does not begin at a label.
class NothingBegins : public ComputationError {
 public:
  using ComputationError::ComputationError;
};

// Warnings and failures, the one way they look.

/// "tchat: TEXT", printable. The file that the environment variable TCHAT_FAILURE names, if any, gets the text as well,
/// so that a program which has started this one need not look for it among other output.
void print_failure(std::ostream& stream, const std::string& text);

/// "tchat: warning: TEXT" for each, printable.
void print_warnings(std::ostream& stream, const std::vector<std::string>& texts);

// Long lines for the screen.

/// Lines of at most 120 characters, broken at blanks, the further ones indented; the last ends with a newline too.
std::string folded(std::string line);

// A line on a terminal that tells how far a computation is, renewed in place and gone when something else is printed.

class ProgressLine {
 public:
  /// `terminal` may be null: nothing is shown.
  explicit ProgressLine(std::ostream* terminal);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Is it time for a new text? Twice a second, and not before half a second has passed.
  bool is_due() const;
  void show(const std::string& text);
  /// Before other text goes to the terminal.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  std::ostream* terminal_;
  Clock::time_point last_;
  bool shown_ = false;
};

}  // namespace tchat

/// A line on a terminal that tells how far a computation is, renewed in place and gone when something else is printed.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace tchat {

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

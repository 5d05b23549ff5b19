#include "base/progress_line.hpp"

namespace tchat {

ProgressLine::ProgressLine(std::ostream* terminal) : terminal_(terminal), last_(Clock::now()) {}

ProgressLine::~ProgressLine() { clear(); }

bool ProgressLine::is_due() const {
  return terminal_ != nullptr && Clock::now() - last_ >= std::chrono::milliseconds(500);
}

void ProgressLine::show(const std::string& text) {
  if (terminal_ == nullptr) return;
  last_ = Clock::now();
  shown_ = true;
  *terminal_ << "\r\033[K" << text << std::flush;
}

void ProgressLine::clear() {
  if (shown_) *terminal_ << "\r\033[K" << std::flush;
  shown_ = false;
}

}  // namespace tchat

#include "base/messages.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace tchat {

std::string printable(std::string_view text) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n') || byte == 0x7f;
  };
  std::string result(text);
  std::replace_if(result.begin(), result.end(), is_control, '?');
  return result;
}

void print_failure(std::ostream& stream, const std::string& text) {
  stream << "tchat: " << printable(text) << '\n';
  if (const char* const path = std::getenv("TCHAT_FAILURE"); path != nullptr) std::ofstream(path) << printable(text);
}

void print_warnings(std::ostream& stream, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) stream << "tchat: warning: " << printable(text) << '\n';
}

std::string folded(std::string line) {
  constexpr std::size_t width = 120;
  const std::string indent = "      ";
  std::string text;
  while (line.size() > width) {
    const std::size_t blank = line.rfind(' ', width);
    if (blank == std::string::npos || blank <= indent.size()) break;
    text += line.substr(0, blank) + '\n';
    line = indent + line.substr(blank + 1);
  }
  return text + line + '\n';
}

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

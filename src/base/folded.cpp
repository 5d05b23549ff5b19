#include "base/folded.hpp"

namespace tchat {

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

}  // namespace tchat

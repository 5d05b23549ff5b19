#include "explore/branch_ends.hpp"

#include <string_view>

#include "base/words.hpp"

namespace tchat {

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return lines;
}

/// A long message without its explanations, which the log has.
std::string first_part(const std::string& text) {
  constexpr std::size_t short_enough = 120;
  if (text.size() <= short_enough) return text;
  const std::size_t end = text.find_first_of(":;", short_enough / 3);
  return end <= short_enough ? text.substr(0, end) : text.substr(0, short_enough) + "...";
}

}  // namespace

std::vector<std::string> branch_ends(const std::string& log) {
  constexpr std::string_view mark = "  stopped: ";
  constexpr std::string_view folded = "    ";  // of the further lines of a long one
  std::vector<std::string> ends;
  bool is_in_one = false;
  for (const std::string& line : lines_of(log)) {
    if (line.starts_with(mark)) {
      ends.push_back(line.substr(mark.size()));
      is_in_one = true;
    } else if (is_in_one && line.starts_with(folded)) {
      ends.back() += " " + std::string(trimmed(line));
    } else {
      is_in_one = false;
    }
  }
  return ends;
}

std::string failure_text(const std::string& log) {
  constexpr std::string_view mark = "tchat: ";
  std::string text;
  for (const std::string& line : lines_of(log)) {
    if (line.starts_with("tchat: warning")) continue;
    if (line.starts_with(mark))
      text = line.substr(mark.size());
    else if (text.empty() && !trimmed(line).empty())
      text = line;
  }
  return first_part(text);
}

}  // namespace tchat

#include "plugin/formula_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "base/near_words.hpp"
#include "base/user_error.hpp"

namespace tchat::formulas {

namespace {

constexpr std::size_t most_told = 10;
constexpr std::size_t longest_shown_line = 100;

std::string_view line_of(std::string_view text, int number) {
  for (int line = 1; line < number; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return "";
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The line of the text with a mark below the place; "" when the line is too long to be shown, or holds bytes whose
/// width on a terminal is not one.
std::string shown_place(std::string_view text, Position at) {
  std::string line(line_of(text, at.line));
  std::replace(line.begin(), line.end(), '\t', ' ');
  const bool plain = std::all_of(line.begin(), line.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  if (!plain || line.size() > longest_shown_line) return "";
  return fmt::format("\n    {}\n    {:>{}}", line, '^', at.column);
}

}  // namespace

void FormulaErrors::throw_if_any(const std::string& path, std::string_view text) const {
  if (errors_.empty()) return;
  std::vector<FormulaError> sorted = errors_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const FormulaError& a, const FormulaError& b) {
    return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
  });
  std::string message;
  for (std::size_t k = 0; k < std::min(most_told, sorted.size()); ++k) {
    const auto& [at, what] = sorted[k];
    if (k > 0) message += '\n';
    message += at.line == 0 ? fmt::format("{}: {}", path, what)
                            : fmt::format("{}:{}:{}: {}{}", path, at.line, at.column, what, shown_place(text, at));
  }
  if (sorted.size() > most_told) message += fmt::format("\n{} more mistakes are not shown", sorted.size() - most_told);
  throw UserError(message);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  const std::vector<std::string> near = near_words(word, known);
  if (near.empty()) return "";
  return fmt::format(" (did you mean '{}'?)", near.front());
}

}  // namespace tchat::formulas

#include "files/solution_labels.hpp"

#include "base/number.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "settings/constant_value.hpp"

namespace tchat {

namespace {

constexpr std::size_t label_place = 3;
constexpr std::size_t points_place = 6;
constexpr std::size_t lines_place = 8;

/// The integers of a solution's first line; nothing when it is none.
std::optional<std::vector<int>> identifier(const std::string& line) {
  std::vector<int> integers;
  for (const std::string_view word : split_words(line)) {
    const auto value = parse_integer(word);
    if (!value || integers.size() == 16) return std::nullopt;
    integers.push_back(*value);
  }
  if (integers.size() != 12 && integers.size() != 16) return std::nullopt;
  return integers;
}

/// False when the file ends before so many lines, or in the last one.
bool skip(TextLines& in, int lines) {
  std::string line;
  for (int k = 0; k < lines; ++k)
    if (!in.next(line) || in.ended_within_line()) return false;
  return true;
}

}  // namespace

std::optional<std::vector<int>> whole_solution_labels(const std::string& path) {
  std::vector<int> labels;
  TextLines in(path, "labelled solutions");
  for (std::string line; in.next(line);) {
    if (split_words(line).empty()) continue;
    const auto integers = identifier(line);
    if (!integers) return in.ended_within_line() ? std::optional(labels) : std::nullopt;
    if (!skip(in, (*integers)[lines_place])) break;
    if ((*integers)[points_place] > 0) labels.push_back((*integers)[label_place]);
  }
  return labels;
}

}  // namespace tchat

#include "base/near_words.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

namespace tchat {

namespace {

/// Least number of insertions, deletions and replacements that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string upper(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> near_words(std::string_view word, std::span<const std::string> known) {
  const std::string wanted = upper(word.substr(0, 32));
  std::vector<std::pair<std::size_t, std::string>> candidates;
  for (const std::string& each : known) {
    const std::string name = upper(each);
    const std::size_t distance = edit_distance(wanted, name);
    const bool part = wanted.size() > 2 && name.find(wanted) != std::string::npos;
    if (part || (distance <= 2 && distance < wanted.size())) candidates.emplace_back(distance, each);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (candidates.size() > 5) candidates.resize(5);
  std::vector<std::string> result;
  for (auto& [distance, name] : candidates) result.push_back(std::move(name));
  return result;
}

}  // namespace tchat

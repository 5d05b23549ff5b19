#include "motion/attractor_kind.hpp"

#include <array>
#include <utility>

namespace tchat {

namespace {

constexpr std::array<std::pair<AttractorKind, const char*>, 7> kind_words = {{
    {AttractorKind::none, "none"},
    {AttractorKind::periodic, "periodic"},
    {AttractorKind::quasi_periodic, "quasi-periodic"},
    {AttractorKind::chaotic, "chaotic"},
    {AttractorKind::rest, "rest"},
    {AttractorKind::chattering, "chattering"},
    {AttractorKind::escape, "escape"},
}};

}  // namespace

std::string to_string(AttractorKind kind) {
  for (const auto& [other, word] : kind_words)
    if (other == kind) return word;
  return "none";
}

std::optional<AttractorKind> attractor_kind(const std::string& word) {
  for (const auto& [kind, other] : kind_words)
    if (other == word) return kind;
  return std::nullopt;
}

}  // namespace tchat

#include "settings/normal_form_note.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/number.hpp"

namespace tchat {

namespace {

constexpr std::string_view beginning = "normal form ", equals = " = ", plus_minus = " +- ", comma = ", ";

/// Removes the text up to and including `end`, and returns what precedes `end`; nothing if `end` is absent.
std::optional<std::string_view> take_until(std::string_view& text, std::string_view end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at + end.size());
  return part;
}

}  // namespace

std::string format_normal_form(const NormalFormNote& note, std::string_view explanation) {
  std::string text =
      fmt::format("{}{}{}{:.10g}{}{:.1g}", beginning, note.name, equals, note.value, plus_minus, note.uncertainty);
  if (!note.verdict.empty()) text += fmt::format("{}{}{}", comma, note.verdict, explanation);
  return text;
}

std::optional<NormalFormNote> parse_normal_form(std::string_view line) {
  if (!take_until(line, beginning)) return std::nullopt;
  const auto name = take_until(line, equals);
  const auto value = take_until(line, plus_minus);
  if (!name || !value) return std::nullopt;
  const auto known_to = line.substr(0, std::min(line.find_first_of(",; "), line.size()));
  const auto number = parse_fortran_real(*value), uncertainty = parse_fortran_real(known_to);
  if (!number || !uncertainty) return std::nullopt;
  line.remove_prefix(known_to.size());
  NormalFormNote note{std::string(*name), *number, *uncertainty};
  if (line.starts_with(comma))
    note.verdict = line.substr(comma.size(), std::min(line.find_first_of(":;"), line.size()) - comma.size());
  return note;
}

}  // namespace tchat

#include "plot/picture_styles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace tchat {

namespace {

/// The first ones differ in hue and in lightness, those of the kinds of curve are among them.
constexpr std::array<const char*, 12> colours = {"#000000", "#0060a8", "#c04000", "#3a9a4a", "#9a5aa0", "#d09a00",
                                                 "#50b8e8", "#e060a0", "#7a4420", "#008a8a", "#8a9a20", "#8888d8"};

/// A third of the way to white.
std::string paler(const std::string& colour) {
  std::string result = "#";
  for (std::size_t k = 1; k + 1 < colour.size(); k += 2)
    result += fmt::format("{:02x}", (2 * std::stoi(colour.substr(k, 2), nullptr, 16) + 255) / 3);
  return result;
}

}  // namespace

std::string cloud_colour(std::size_t k) {
  constexpr std::array<const char*, 4> pale = {"#a8a8a8", "#8ab8e0", "#e8b088", "#9cd0a4"};
  return pale[k % pale.size()];
}

Marker cloud_marker(const std::string& colour) { return {{}, Symbol::dot, true, 0.5, colour}; }

std::string series_colour(std::size_t k) { return colours[k % colours.size()]; }

Symbol series_symbol(std::size_t k) {
  constexpr std::array<Symbol, 5> symbols = {Symbol::circle, Symbol::square, Symbol::triangle, Symbol::diamond,
                                             Symbol::reversed_triangle};
  return symbols[k % symbols.size()];
}

Stroke line_stroke(LineKind kind, const std::string& colour, double width) {
  switch (kind) {
    case LineKind::stable:
      return {Dash::solid, width, colour};
    case LineKind::unstable:
      return {Dash::dashed, 0.75 * width, colour};
    default:
      return {Dash::dotted, 0.8 * width, paler(colour)};
  }
}

Stroke jump_stroke(const std::string& colour) { return {Dash::solid, 1.3, paler(colour)}; }

std::vector<KeyEntry> line_kind_entries(const std::set<LineKind>& kinds, const std::string& colour, double width) {
  const auto name = [](LineKind kind) {
    return kind == LineKind::stable ? "stable" : kind == LineKind::unstable ? "unstable" : "inadmissible";
  };
  std::vector<KeyEntry> entries;
  for (const LineKind kind : kinds)
    entries.push_back({plain_text(name(kind)), line_stroke(kind, colour, width), std::nullopt});
  return entries;
}

Marker special_point_marker(const std::string& type, const PicturePoint& at) {
  const PointTypeFacts* const facts = find_point_type(type);
  Marker marker;
  marker.at = at;
  marker.symbol = facts != nullptr ? facts->symbol : Symbol::dot;
  marker.filled = facts == nullptr || facts->is_filled;
  marker.one_of_many = type == "XI";
  marker.size = marker.one_of_many ? 0.8 : 1.0;
  marker.label = plain_text(type);
  return marker;
}

bool is_labelled_by_default(const std::string& type) {
  const PointTypeFacts* const facts = find_point_type(type);
  return facts != nullptr && facts->is_labelled;
}

std::vector<std::string> all_point_types() {
  std::vector<std::string> types;
  for (const PointTypeFacts& row : point_types())
    if (types.empty() || types.back() != row.name) types.emplace_back(row.name);
  return types;
}

CurveKind curve_kind(const std::string& letters, bool grazing) {
  if (grazing) return {"grazing", "#000000", Symbol::circle, false};
  static const std::map<std::string, CurveKind> kinds{
      {"LP", {"fold", "#0060a8", Symbol::square, true}},
      {"PD", {"period doubling", "#c04000", Symbol::triangle, true}},
      {"TR", {"torus", "#3a9a4a", Symbol::diamond, true}},
      {"GR", {"two events at once", "#008080", Symbol::circle, false}},
      {"BE", {"boundary equilibrium", "#008080", Symbol::pentagon, false}},
      {"HB", {"Hopf", "#9a5aa0", Symbol::reversed_triangle, true}},
      {"BP", {"branch points", "#7a4420", Symbol::pentagon, true}},
  };
  const auto known = kinds.find(letters);
  return known != kinds.end() ? known->second : CurveKind{"two-parameter curve", "#000000", Symbol::dot, true};
}

std::string unused_colour(const std::vector<CurveKind>& curves, std::size_t k) {
  std::vector<std::string> unused;
  for (const char* colour : colours)
    if (std::none_of(curves.begin(), curves.end(), [colour](const CurveKind& curve) { return curve.colour == colour; }))
      unused.emplace_back(colour);
  return unused.empty() ? series_colour(k) : unused[k % unused.size()];
}

std::vector<CurveKind> with_own_colours(std::vector<CurveKind> kinds) {
  std::vector<CurveKind> first_ones;
  const auto is_first = [&first_ones](const CurveKind& kind) {
    return std::none_of(first_ones.begin(), first_ones.end(),
                        [&kind](const CurveKind& other) { return other.name == kind.name; });
  };
  std::vector<CurveKind*> further;
  for (CurveKind& kind : kinds) {
    if (is_first(kind))
      first_ones.push_back(kind);
    else
      further.push_back(&kind);
  }
  for (std::size_t k = 0; k < further.size(); ++k) further[k]->colour = unused_colour(first_ones, k);
  return kinds;
}

}  // namespace tchat

#include "plot/picture_styles.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace tchat {

namespace {

struct PointStyle {
  const char* type;
  Symbol symbol;
  bool filled;
  bool by_default;
};

constexpr std::array<PointStyle, 26> point_styles = {{
    {"LP", Symbol::square, true, true},
    {"PD", Symbol::triangle, true, true},
    {"TR", Symbol::diamond, true, true},
    {"BP", Symbol::pentagon, true, true},
    {"HB", Symbol::reversed_triangle, true, true},
    {"GR", Symbol::circle, false, true},
    {"XI", Symbol::circle, true, true},
    {"GC", Symbol::diamond, false, true},
    {"CP", Symbol::square, false, true},
    {"R1", Symbol::reversed_triangle, false, true},
    {"R2", Symbol::triangle, false, true},
    {"R3", Symbol::pentagon, false, true},
    {"R4", Symbol::diamond, false, true},
    {"BT", Symbol::reversed_triangle, false, true},
    {"ZH", Symbol::pentagon, false, true},
    {"GH", Symbol::diamond, false, true},
    {"LTR", Symbol::square, false, true},
    {"LPD", Symbol::square, false, true},
    {"PTR", Symbol::triangle, false, true},
    {"TTR", Symbol::diamond, false, true},
    {"UZ", Symbol::circle, true, false},
    {"RG", Symbol::dot, true, false},
    {"EP", Symbol::dot, true, false},
    {"MX", Symbol::reversed_triangle, true, false},
    {"FP", Symbol::square, true, true},
    {"", Symbol::dot, true, false},
}};

/// The first ones differ in hue and in lightness, those of the kinds of curve are among them.
constexpr std::array<const char*, 12> colours = {"#000000", "#0060a8", "#c04000", "#3a9a4a", "#9a5aa0", "#d09a00",
                                                 "#50b8e8", "#e060a0", "#7a4420", "#008a8a", "#8a9a20", "#8888d8"};

const PointStyle& style_of(const std::string& type) {
  const auto found = std::find_if(point_styles.begin(), point_styles.end(),
                                  [&type](const PointStyle& style) { return type == style.type; });
  return found != point_styles.end() ? *found : point_styles.back();
}

}  // namespace

std::string cloud_colour(std::size_t k) {
  constexpr std::array<const char*, 4> pale = {"#a8a8a8", "#8ab8e0", "#e8b088", "#9cd0a4"};
  return pale[k % pale.size()];
}

Marker cloud_marker(const std::string& colour) {
  Marker marker;
  marker.symbol = Symbol::dot;
  marker.size = 0.5;
  marker.colour = colour;
  return marker;
}

std::string series_colour(std::size_t k) { return colours[k % colours.size()]; }

Stroke series_stroke(std::size_t k, double width) {
  static constexpr std::array<Dash, 4> dashes = {Dash::solid, Dash::dashed, Dash::dash_dot, Dash::dotted};
  return {dashes[k % dashes.size()], width, series_colour(k), static_cast<int>(k / dashes.size() % 4)};
}

Marker special_point_marker(const std::string& type, const PicturePoint& at) {
  const PointStyle& style = style_of(type);
  Marker marker;
  marker.at = at;
  marker.symbol = style.symbol;
  marker.filled = style.filled;
  marker.one_of_many = type == "XI";
  marker.size = marker.one_of_many ? 0.8 : 1.0;
  marker.label = plain_text(type);
  return marker;
}

bool is_labelled_by_default(const std::string& type) { return style_of(type).by_default; }

std::vector<std::string> all_point_types() {
  std::vector<std::string> types;
  for (const PointStyle& style : point_styles)
    if (*style.type != '\0' && std::string(style.type) != "FP") types.emplace_back(style.type);
  return types;
}

CurveKind curve_kind(int curve_type, bool grazing) {
  if (grazing) return {"grazing", {Dash::solid, 2.6, "#000000"}};
  switch (curve_type) {
    case 2:
    case 5:
      return {"fold", {Dash::dashed, 2.6, "#0060a8"}};
    case 7:
      return {"period doubling", {Dash::dash_dot, 2.6, "#c04000"}};
    case 8:
      return {"torus", {Dash::dotted, 3.2, "#3a9a4a"}};
    case 3:
      return {"Hopf", {Dash::dash_dot, 2.6, "#9a5aa0"}};
    case 1:
    case 6:
      return {"branch points", {Dash::dotted, 3.2, "#7a4420"}};
    default:
      return {"two-parameter curve", {Dash::solid, 2.6, "#000000"}};
  }
}

std::string unused_colour(const std::vector<Stroke>& lines, std::size_t k) {
  std::vector<std::string> unused;
  for (const char* colour : colours)
    if (std::none_of(lines.begin(), lines.end(), [colour](const Stroke& line) { return line.colour == colour; }))
      unused.emplace_back(colour);
  return unused.empty() ? series_colour(k) : unused[k % unused.size()];
}

std::vector<Stroke> curve_strokes(const std::vector<CurveKind>& kinds) {
  std::map<std::string, int> count;
  std::vector<Stroke> strokes, own_colours;
  for (const CurveKind& kind : kinds) {
    strokes.push_back(kind.stroke);
    strokes.back().variant = count[kind.name]++;
    if (strokes.back().variant == 0) own_colours.push_back(kind.stroke);
  }
  std::size_t further = 0;
  for (Stroke& stroke : strokes)
    if (stroke.variant > 0) stroke.colour = unused_colour(own_colours, further++);
  return strokes;
}

}  // namespace tchat

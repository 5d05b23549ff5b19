#include "plot/page_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/messages.hpp"
#include "files/table_writer.hpp"
#include "plot/figure.hpp"

namespace tchat {

namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";  // U+FFFD

unsigned char byte_at(std::string_view text, std::size_t k) { return static_cast<unsigned char>(text[k]); }

/// Bytes of the UTF-8 character that begins at `k`; 0 where none does. Overlong forms, surrogates and numbers beyond
/// U+10FFFF are none.
std::size_t character_length(std::string_view text, std::size_t k) {
  const unsigned char first = byte_at(text, k);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : (first & 0xF0) == 0xE0        ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || k + length > text.size()) return 0;
  for (std::size_t j = 1; j < length; ++j)
    if ((byte_at(text, k + j) & 0xC0) != 0x80) return 0;
  const unsigned char second = byte_at(text, k + 1);
  const bool is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool is_beyond = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return is_overlong || is_beyond ? 0 : length;
}

std::string escaped_byte(unsigned char c) {
  if (c < 0x20 || c == 0x7f) return " ";
  if (c == '"' || c == '\\') return std::string("\\") + static_cast<char>(c);
  if (c == '<' || c == '>' || c == '&') return fmt::format("\\u{:04x}", c);
  return std::string(1, static_cast<char>(c));
}

}  // namespace

std::string page_text(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t length = character_length(text, k);
    if (length == 0)
      quoted += replacement;
    else
      quoted += length == 1 ? escaped_byte(byte_at(text, k)) : std::string(text.substr(k, length));
    k += std::max<std::size_t>(length, 1);
  }
  return quoted + '"';
}

std::string page_label(const LabelText& text) {
  return text.markup ? page_object({{"t", page_text(text.text)}, {"m", "1"}})
                     : page_object({{"t", page_text(text.text)}});
}

std::string page_number(double value) { return can_be_shown(value) ? json_value(value) : "null"; }

std::string page_number(double value, int digits) {
  return can_be_shown(value) ? fmt::format("{:.{}g}", value, digits) : "null";
}

std::string page_list(const std::vector<std::string>& values) { return fmt::format("[{}]", fmt::join(values, ",")); }

std::string page_object(std::initializer_list<std::pair<std::string_view, std::string>> members) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : members) texts.push_back(fmt::format("\"{}\":{}", name, value));
  return fmt::format("{{{}}}", fmt::join(texts, ","));
}

namespace {

constexpr int drawn_digits = 10;            // of what is drawn: enough to zoom far into it
constexpr std::size_t most_dots = 200'000;  // of a cloud that is embedded whole

std::string drawn_number(double value) { return page_number(value, drawn_digits); }

std::string truth(bool value) { return value ? "1" : "0"; }

const char* symbol_name(Symbol symbol) {
  switch (symbol) {
    case Symbol::square:
      return "square";
    case Symbol::triangle:
      return "triangle";
    case Symbol::reversed_triangle:
      return "reversed_triangle";
    case Symbol::diamond:
      return "diamond";
    case Symbol::pentagon:
      return "pentagon";
    case Symbol::dot:
      return "dot";
    default:
      return "circle";
  }
}

const char* dash_name(Dash dash) {
  switch (dash) {
    case Dash::solid:
      return "solid";
    case Dash::dashed:
      return "dashed";
    default:
      return "dotted";
  }
}

std::string stroke_json(const Stroke& stroke) {
  return page_object({{"dash", page_text(dash_name(stroke.dash))},
                      {"width", drawn_number(stroke.width)},
                      {"colour", page_text(stroke.colour)}});
}

/// The look of a marker.
std::string symbol_json(const Marker& marker) {
  return page_object({{"symbol", page_text(symbol_name(marker.symbol))},
                      {"filled", truth(marker.filled)},
                      {"size", page_number(marker.size, 4)},
                      {"colour", page_text(marker.colour)}});
}

/// x, y, x, y, ...; a point that cannot be shown is a pair of nulls.
std::string flat_points(const std::vector<PicturePoint>& points) {
  std::vector<std::string> values;
  for (const PicturePoint& p : points) {
    const bool is_gap = !is_finite(p);
    values.push_back(is_gap ? "null" : drawn_number(p.x));
    values.push_back(is_gap ? "null" : drawn_number(p.y));
  }
  return page_list(values);
}

std::string curve_json(const Curve& curve, double dash_scale) {
  return page_object({{"points", flat_points(curve.points)},
                      {"stroke", stroke_json(curve.stroke)},
                      {"dashScale", page_number(dash_scale, 3)},
                      {"background", truth(curve.background)}});
}

std::string row_json(const std::optional<std::size_t>& row) { return row ? fmt::format("{}", *row) : "null"; }

/// The rows of the page's sweep that these points or cells are from; null where they are from elsewhere.
std::string rows_json(const SweepRows& rows, const std::vector<std::size_t>& indices, const FilePlaces& places) {
  if (rows.rows.empty()) return "null";
  return page_object({{"sweep", fmt::format("{}", places.sweeps[rows.sweep])},
                      {"rows", page_list(indices, [&](std::size_t k) { return row_json(rows.rows[k]); })}});
}

std::string cloud_json(const Cloud& cloud, const PanelLayout& layout, double font, const FilePlaces& places) {
  const double side = 0.6 * cloud.size * marker_radius * font;
  const std::vector<std::size_t> indices = thinned_indices(cloud.points, layout, side, most_dots);
  std::vector<PicturePoint> points;
  for (const std::size_t k : indices) points.push_back(cloud.points[k]);
  const auto level = [](const PicturePoint& p) { return page_number(p.z, 6); };
  return page_object({{"points", flat_points(points)},
                      {"colour", page_text(cloud.colour)},
                      {"size", page_number(cloud.size, 4)},
                      {"levels", cloud.colour == "palette" ? page_list(points, level) : "null"},
                      {"from", rows_json(cloud.rows, indices, places)}});
}

std::string field_json(const ColourField& field, const FilePlaces& places) {
  std::vector<std::size_t> indices(field.cells.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  const auto corner = [](const PicturePoint& p) { return page_list({page_number(p.x), page_number(p.y)}); };
  return page_object({{"columns", fmt::format("{}", field.columns)},
                      {"rows", fmt::format("{}", field.rows)},
                      {"first", corner(field.first)},
                      {"last", corner(field.last)},
                      {"cells", page_list(field.cells, [](double cell) { return drawn_number(cell); })},
                      {"from", rows_json(field.sweep_rows, indices, places)}});
}

std::string axis_json(const AxisScale& scale, const LabelText& label) {
  return page_object({{"label", page_label(label)},
                      {"low", page_number(scale.low)},
                      {"high", page_number(scale.high)},
                      {"log", truth(scale.logarithmic)}});
}

/// From the marker to the middle of its label, in units of the font's size; null where the picture has no room for it.
std::string label_offset(const PanelLayout& layout, const Marker& marker, std::size_t k, double font) {
  if (k >= layout.labels.size() || !layout.labels[k]) return "null";
  const PicturePoint at = layout.on_paper(marker.at), centre = layout.labels[k]->box.centre();
  return page_list({page_number((centre.x - at.x) / font, 4), page_number((centre.y - at.y) / font, 4)});
}

std::string marker_json(const Marker& marker, double scale, const std::string& offset) {
  Marker scaled = marker;
  scaled.size *= scale;
  return page_object({{"x", page_number(marker.at.x)},
                      {"y", page_number(marker.at.y)},
                      {"look", symbol_json(scaled)},
                      {"label", page_label(marker.label)},
                      {"offset", offset},
                      {"point", marker.computed ? fmt::format("{}", *marker.computed) : "null"}});
}

std::string markers_json(const Panel& panel, const PanelLayout& layout, double font) {
  std::vector<std::string> markers;
  for (std::size_t k = 0; k < panel.markers.size(); ++k)
    markers.push_back(
        marker_json(panel.markers[k], layout.marker_scales[k], label_offset(layout, panel.markers[k], k, font)));
  return page_list(markers);
}

/// The computed points of branches: where they are and what they are, in one list for each quantity.
std::string computed_json(const std::vector<ComputedPoint>& points, const FilePlaces& places) {
  const auto index = [](std::size_t k) { return fmt::format("{}", k); };
  return page_object(
      {{"x", page_list(points, [](const ComputedPoint& p) { return page_number(p.at.x); })},
       {"y", page_list(points, [](const ComputedPoint& p) { return page_number(p.at.y); })},
       {"branch", page_list(points, [&](const ComputedPoint& p) { return index(places.branches[p.file]); })},
       {"section", page_list(points, [&](const ComputedPoint& p) { return index(p.section); })},
       {"row", page_list(points, [&](const ComputedPoint& p) { return index(p.row); })}});
}

std::string panel_json(const Panel& panel, const PanelLayout& layout, double font, const FilePlaces& places) {
  if (panel.z)
    throw UserError(
        "-o FILE.html: a page draws in the plane; leave -z out (the page lets you choose two states), or write "
        "FILE.png");
  std::vector<std::string> curves;
  for (std::size_t k = 0; k < panel.curves.size(); ++k)
    curves.push_back(curve_json(panel.curves[k], layout.dash_scales[k]));
  const auto symbol = [](const Marker& marker) { return marker_json(marker, 1.0, "null"); };
  const auto cloud = [&](const Cloud& one) { return cloud_json(one, layout, font, places); };
  const auto arrow = [](const Arrow& one) {
    return page_object({{"points", flat_points({one.from, one.to})}, {"colour", page_text(one.colour)}});
  };
  return page_object({{"x", axis_json(layout.x, panel.x.label)},
                      {"y", axis_json(layout.y, panel.y.label)},
                      {"equal", truth(panel.equal_scales)},
                      {"field", panel.field ? field_json(*panel.field, places) : "null"},
                      {"clouds", page_list(panel.clouds, cloud)},
                      {"curves", page_list(curves)},
                      {"symbols", page_list(layout.symbols, symbol)},
                      {"arrows", page_list(panel.arrows, arrow)},
                      {"markers", markers_json(panel, layout, font)},
                      {"computed", computed_json(panel.computed, places)}});
}

std::string key_entry_json(const KeyEntry& entry) {
  return page_object({{"text", page_label(entry.text)},
                      {"stroke", entry.stroke ? stroke_json(*entry.stroke) : "null"},
                      {"marker", entry.marker ? symbol_json(*entry.marker) : "null"}});
}

std::string palette_json(const Palette& palette) {
  const auto stop = [](const std::pair<double, std::string>& one) {
    return page_list({drawn_number(one.first), page_text(one.second)});
  };
  return page_object({{"stops", page_list(palette.stops, stop)},
                      {"label", page_label(palette.label)},
                      {"bar", truth(palette.has_bar)}});
}

}  // namespace

std::string figure_json(const PlacedFigure& placed, const FilePlaces& places) {
  const Figure& figure = placed.figure;
  std::vector<std::string> panels;
  for (std::size_t k = 0; k < figure.panels.size(); ++k)
    panels.push_back(panel_json(figure.panels[k], placed.layout.panels[k], placed.layout.font, places));
  return page_object({{"width", fmt::format("{}", figure.width)},
                      {"height", fmt::format("{}", figure.height)},
                      {"title", page_label(figure.title)},
                      {"note", page_label(figure.note)},
                      {"key", page_list(figure.key, key_entry_json)},
                      {"palette", figure.palette ? palette_json(*figure.palette) : "null"},
                      {"panels", page_list(panels)}});
}

}  // namespace tchat

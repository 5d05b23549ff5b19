#include "plot/short_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

// In units of the font's size:
constexpr double few_dashes = 1.6;    // a piece of this length shows four dashes
constexpr double label_length = 3.0;  // a label could hide it
constexpr double marker_length = 1.4;
constexpr double smallest_dashes = 0.4;
constexpr double smaller_marker = 0.7;

double length_on_paper(const Curve& curve, const PanelLayout& layout) {
  double length = 0.0;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const PicturePoint a = layout.on_paper(curve.points[k - 1]), b = layout.on_paper(curve.points[k]);
    if (is_finite(a) && is_finite(b)) length += std::hypot(b.x - a.x, b.y - a.y);
  }
  return length;
}

/// Small boxes along the curve.
void add_boxes(const Curve& curve, const PanelLayout& layout, double font, std::vector<Box>& boxes) {
  constexpr double size = 0.4;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const PicturePoint a = layout.on_paper(curve.points[k - 1]), b = layout.on_paper(curve.points[k]);
    if (!is_finite(a) || !is_finite(b)) continue;
    const int parts = 1 + static_cast<int>(std::hypot(b.x - a.x, b.y - a.y) / (size * font));
    for (int i = 0; i < parts; ++i) {
      const double from = static_cast<double>(i) / parts, to = static_cast<double>(i + 1) / parts;
      const auto [left, right] = std::minmax({a.x + from * (b.x - a.x), a.x + to * (b.x - a.x)});
      const auto [bottom, top] = std::minmax({a.y + from * (b.y - a.y), a.y + to * (b.y - a.y)});
      boxes.push_back(Box{left, right, bottom, top}.grown(1.0));
    }
  }
}

bool is_at_end_of(const Curve& curve, const PicturePoint& at) {
  const auto same = [&at](const PicturePoint& end) { return end.x == at.x && end.y == at.y; };
  return same(curve.points.front()) || same(curve.points.back());
}

}  // namespace

ShortPieces find_short_pieces(const Panel& panel, const PanelLayout& layout, double font) {
  ShortPieces result{std::vector<double>(panel.curves.size(), 1.0), std::vector<double>(panel.markers.size(), 1.0), {}};
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    if (curve.stroke.dash == Dash::solid || curve.points.size() < 2) continue;
    const double length = length_on_paper(curve, layout) / font;
    result.dash_scales[c] = std::clamp(length / few_dashes, smallest_dashes, 1.0);
    if (length < label_length) add_boxes(curve, layout, font, result.boxes);
    if (length > marker_length) continue;
    for (std::size_t m = 0; m < panel.markers.size(); ++m)
      if (is_at_end_of(curve, panel.markers[m].at)) result.marker_scales[m] = smaller_marker;
  }
  return result;
}

}  // namespace tchat

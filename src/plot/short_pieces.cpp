#include "plot/short_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

Box box_around(const Curve& curve, const PanelLayout& layout) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Box box{far, -far, far, -far};
  for (const PicturePoint& point : curve.points) {
    const PicturePoint at = layout.on_paper(point);
    box.left = std::min(box.left, at.x), box.right = std::max(box.right, at.x);
    box.bottom = std::min(box.bottom, at.y), box.top = std::max(box.top, at.y);
  }
  return box;
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
    if (length < label_length) result.boxes.push_back(box_around(curve, layout));
    if (length > marker_length) continue;
    for (std::size_t m = 0; m < panel.markers.size(); ++m)
      if (is_at_end_of(curve, panel.markers[m].at)) result.marker_scales[m] = smaller_marker;
  }
  return result;
}

}  // namespace tchat

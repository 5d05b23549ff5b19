#include "plot/curve_symbols.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tchat {

namespace {

// In units of the font's size:
constexpr double symbol_distance = 9.0;
constexpr double shortest_line = 3.0;
constexpr double clear_of_markers = 1.3;
constexpr double clear_of_frame = 0.6;

double distance(const PicturePoint& a, const PicturePoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// A line on the paper, measured where it is seen.
class VisibleLine {
 public:
  VisibleLine(const Curve& curve, const PanelLayout& layout, const Box& frame) {
    for (const PicturePoint& point : curve.points) {
      const PicturePoint at = layout.on_paper(point);
      if (!points_.empty()) {
        const bool seen =
            is_finite(at) && is_finite(points_.back()) && frame.contains(at) && frame.contains(points_.back());
        ends_.push_back(length() + (seen ? distance(points_.back(), at) : 0.0));
      }
      points_.push_back(at);
    }
  }

  double length() const { return ends_.empty() ? 0.0 : ends_.back(); }

  /// The point at this length from the beginning, between 0 and length().
  PicturePoint at(double wanted) const {
    const auto k = static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), wanted) - ends_.begin());
    const double begin = k == 0 ? 0.0 : ends_[k - 1];
    const double part = ends_[k] > begin ? (wanted - begin) / (ends_[k] - begin) : 0.0;
    const PicturePoint a = points_[k], b = points_[k + 1];
    return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
  }

 private:
  std::vector<PicturePoint> points_;
  std::vector<double> ends_;  // length up to the end of each interval
};

/// The place nearest to the wanted length that is clear of these points.
std::optional<PicturePoint> clear_place(const VisibleLine& line, double wanted, const std::vector<PicturePoint>& taken,
                                        double font) {
  for (const double shift : {0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0}) {
    const double length = wanted + shift * font;
    if (length <= 0.0 || length >= line.length()) continue;
    const PicturePoint place = line.at(length);
    const bool is_clear = std::all_of(taken.begin(), taken.end(), [&](const PicturePoint& other) {
      return distance(place, other) > clear_of_markers * font;
    });
    if (is_clear) return place;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Marker> symbols_along_curves(const Panel& panel, const PanelLayout& layout, double font) {
  std::vector<PicturePoint> taken;
  for (const Marker& marker : panel.markers) taken.push_back(layout.on_paper(marker.at));
  std::vector<Marker> symbols;
  for (const Curve& curve : panel.curves) {
    if (!curve.symbol) continue;
    const VisibleLine line(curve, layout, layout.frame.grown(-clear_of_frame * font));
    if (!(line.length() > shortest_line * font)) continue;
    const int count = std::max(1, static_cast<int>(std::lround(line.length() / (symbol_distance * font))));
    for (int i = 0; i < count; ++i) {
      const auto place = clear_place(line, (i + 0.5) * line.length() / count, taken, font);
      if (!place) continue;
      taken.push_back(*place);
      symbols.push_back(*curve.symbol);
      symbols.back().at = layout.in_data(*place);
    }
  }
  return symbols;
}

}  // namespace tchat

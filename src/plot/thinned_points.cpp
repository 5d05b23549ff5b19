#include "plot/thinned_points.hpp"

#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace tchat {

std::vector<std::size_t> thinned_indices(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few) {
  std::vector<std::size_t> kept;
  std::unordered_set<std::uint64_t> taken;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const PicturePoint& point = points[k];
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
    if (points.size() > few) {
      const PicturePoint at = panel.on_paper(point);
      if (!std::isfinite(at.x) || !std::isfinite(at.y) || !panel.frame.grown(side).contains(at)) continue;
      const auto column = static_cast<std::uint64_t>((at.x + side) / side);
      const auto row = static_cast<std::uint64_t>((at.y + side) / side);
      if (!taken.insert((column << 32U) | row).second) continue;
    }
    kept.push_back(k);
  }
  return kept;
}

std::vector<PicturePoint> thinned_points(const std::vector<PicturePoint>& points, const PanelLayout& panel, double side,
                                         std::size_t few) {
  std::vector<PicturePoint> kept;
  for (const std::size_t k : thinned_indices(points, panel, side, few)) kept.push_back(points[k]);
  return kept;
}

}  // namespace tchat

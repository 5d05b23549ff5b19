#include "plot/zero_contour.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace tchat {

namespace {

/// Number of a grid edge: 2 (row * (cells + 1) + column), plus one for the edge upwards.
using Edge = std::int64_t;

class Contour {
 public:
  Contour(const std::function<double(double, double)>& h, PicturePoint low, PicturePoint high, int cells)
      : low_(low), step_{(high.x - low.x) / cells, (high.y - low.y) / cells}, cells_(cells) {
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) values_.push_back(h(at(i, j).x, at(i, j).y));
  }

  std::vector<std::vector<PicturePoint>> trace() {
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i) add_cell(i, j);
    std::vector<std::vector<PicturePoint>> lines;
    while (!neighbours_.empty()) lines.push_back(simplified(next_line()));
    return lines;
  }

 private:
  PicturePoint at(int i, int j) const { return {low_.x + i * step_.x, low_.y + j * step_.y}; }
  double value(int i, int j) const { return values_[static_cast<std::size_t>(j * (cells_ + 1) + i)]; }
  Edge edge(int i, int j, bool upwards) const {
    return 2 * (static_cast<Edge>(j) * (cells_ + 1) + i) + (upwards ? 1 : 0);
  }

  /// Is there a zero between two corners? Zero itself counts as positive.
  static bool crosses(double a, double b) { return (a < 0.0) != (b < 0.0); }

  void add_cell(int i, int j) {
    const double a = value(i, j), b = value(i + 1, j), c = value(i + 1, j + 1), d = value(i, j + 1);
    if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(c) || !std::isfinite(d)) return;
    std::vector<Edge> cut;
    if (crosses(a, b)) cut.push_back(edge(i, j, false));
    if (crosses(b, c)) cut.push_back(edge(i + 1, j, true));
    if (crosses(d, c)) cut.push_back(edge(i, j + 1, false));
    if (crosses(a, d)) cut.push_back(edge(i, j, true));
    if (cut.size() >= 2) connect(cut[0], cut[1]);
    if (cut.size() == 4) connect(cut[2], cut[3]);
  }

  void connect(Edge a, Edge b) {
    neighbours_[a].push_back(b);
    neighbours_[b].push_back(a);
  }

  /// Takes one polyline out of the graph, from an end where there is one.
  std::vector<PicturePoint> next_line() {
    auto start =
        std::find_if(neighbours_.begin(), neighbours_.end(), [](const auto& n) { return n.second.size() == 1; });
    if (start == neighbours_.end()) start = neighbours_.begin();
    Edge here = start->first;
    std::vector<PicturePoint> line{zero_on(here)};
    for (auto found = neighbours_.find(here); found != neighbours_.end() && !found->second.empty();
         found = neighbours_.find(here)) {
      const Edge next = found->second.back();
      found->second.pop_back();
      if (found->second.empty()) neighbours_.erase(found);
      auto& back = neighbours_[next];
      back.erase(std::find(back.begin(), back.end(), here));
      if (back.empty()) neighbours_.erase(next);
      line.push_back(zero_on(next));
      here = next;
    }
    return line;
  }

  PicturePoint zero_on(Edge number) const {
    const bool upwards = number % 2 == 1;
    const auto i = static_cast<int>(number / 2 % (cells_ + 1));
    const auto j = static_cast<int>(number / 2 / (cells_ + 1));
    const int i2 = upwards ? i : i + 1, j2 = upwards ? j + 1 : j;
    const double a = value(i, j), b = value(i2, j2);
    const double part = a / (a - b);
    const PicturePoint from = at(i, j), to = at(i2, j2);
    return {from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)};
  }

  /// Without the points that lie on the line between their neighbours.
  std::vector<PicturePoint> simplified(const std::vector<PicturePoint>& line) const {
    std::vector<PicturePoint> result;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const bool inside = k > 0 && k + 1 < line.size();
      if (!inside || !is_straight(result.back(), line[k], line[k + 1])) result.push_back(line[k]);
    }
    return result;
  }

  bool is_straight(const PicturePoint& a, const PicturePoint& b, const PicturePoint& c) const {
    const double x1 = (b.x - a.x) / step_.x, y1 = (b.y - a.y) / step_.y;
    const double x2 = (c.x - b.x) / step_.x, y2 = (c.y - b.y) / step_.y;
    return std::abs(x1 * y2 - y1 * x2) < 1e-6 && x1 * x2 + y1 * y2 >= 0.0;
  }

  PicturePoint low_;
  PicturePoint step_;
  int cells_;
  std::vector<double> values_;  // at the corners, row by row
  std::map<Edge, std::vector<Edge>> neighbours_;
};

}  // namespace

std::vector<std::vector<PicturePoint>> zero_contour(const std::function<double(double, double)>& h, PicturePoint low,
                                                    PicturePoint high, int cells) {
  return Contour(h, low, high, cells).trace();
}

}  // namespace tchat

#include "plot/smooth_line.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

constexpr double fine_enough = 0.008;  // parts of the picture
constexpr int most_parts = 12;
constexpr double corner_cosine = 0.5;  // turns by more than 60 degrees are corners

class SmoothLine {
 public:
  SmoothLine(const std::vector<PicturePoint>& points, const PicturePoint& scale) : points_(points), scale_(scale) {}

  std::vector<PicturePoint> interval(std::size_t k) const {
    const PicturePoint a = points_[k], b = points_[k + 1];
    const double length = distance(a, b);
    if (!is_finite(a) || !is_finite(b) || !(length > fine_enough) || !std::isfinite(length)) return {a, b};
    const int parts = std::clamp(static_cast<int>(std::ceil(length / fine_enough)), 2, most_parts);
    const PicturePoint slope_a = slope(k, length, a, b), slope_b = slope(k + 1, length, a, b);
    std::vector<PicturePoint> result{a};
    for (int i = 1; i < parts; ++i) result.push_back(hermite(a, b, slope_a, slope_b, static_cast<double>(i) / parts));
    result.push_back(b);
    return result;
  }

 private:
  double distance(const PicturePoint& a, const PicturePoint& b) const {
    return std::hypot((b.x - a.x) / scale_.x, (b.y - a.y) / scale_.y);
  }

  /// Derivative at point k over an interval of that length; at ends and corners the straight line's.
  PicturePoint slope(std::size_t k, double length, const PicturePoint& a, const PicturePoint& b) const {
    const PicturePoint straight{b.x - a.x, b.y - a.y};
    if (k == 0 || k + 1 >= points_.size()) return straight;
    const PicturePoint before = points_[k - 1], here = points_[k], after = points_[k + 1];
    const double first = distance(before, here), second = distance(here, after);
    if (!(first > 0.0) || !(second > 0.0) || !std::isfinite(first + second)) return straight;
    const double cosine = ((here.x - before.x) * (after.x - here.x) / (scale_.x * scale_.x) +
                           (here.y - before.y) * (after.y - here.y) / (scale_.y * scale_.y)) /
                          (first * second);
    if (cosine < corner_cosine) return straight;
    const auto derivative = [&](double p, double q, double r) {
      return length * ((q - p) / first * second + (r - q) / second * first) / (first + second);
    };
    return {derivative(before.x, here.x, after.x), derivative(before.y, here.y, after.y)};
  }

  static PicturePoint hermite(const PicturePoint& a, const PicturePoint& b, const PicturePoint& slope_a,
                              const PicturePoint& slope_b, double t) {
    const double t2 = t * t, t3 = t2 * t;
    const double wa = 2.0 * t3 - 3.0 * t2 + 1.0, wb = 1.0 - wa, va = t3 - 2.0 * t2 + t, vb = t3 - t2;
    return {wa * a.x + wb * b.x + va * slope_a.x + vb * slope_b.x,
            wa * a.y + wb * b.y + va * slope_a.y + vb * slope_b.y};
  }

  const std::vector<PicturePoint>& points_;
  PicturePoint scale_;
};

}  // namespace

std::vector<std::vector<PicturePoint>> smooth_intervals(const std::vector<PicturePoint>& points,
                                                        const PicturePoint& scale) {
  const SmoothLine line(points, scale);
  std::vector<std::vector<PicturePoint>> intervals;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) intervals.push_back(line.interval(k));
  return intervals;
}

}  // namespace tchat

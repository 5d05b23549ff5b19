#include "plot/branch_figure.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;

TEST_CASE("the line passes through every point and is close to the smooth curve") {
  std::vector<PicturePoint> points;
  for (int k = 0; k <= 16; ++k) points.push_back({std::cos(0.2 * k), 5.0 * std::sin(0.2 * k)});
  const auto intervals = smooth_intervals(points, {2.0, 10.0});
  REQUIRE(intervals.size() == points.size() - 1);
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    CHECK(intervals[k].front().x == points[k].x);
    CHECK(intervals[k].back().y == points[k + 1].y);
    CHECK(intervals[k].size() > 2);
    if (k == 0 || k + 1 == intervals.size()) continue;  // one-sided slopes
    for (const PicturePoint& p : intervals[k]) CHECK(std::hypot(p.x, p.y / 5.0) == Approx(1.0).margin(5e-4));
  }
}

TEST_CASE("corners stay corners, gaps stay gaps, close points are left alone") {
  const auto corner = smooth_intervals({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {1.0, 1.0});
  for (const PicturePoint& p : corner[0]) CHECK(p.y == 0.0);
  for (const PicturePoint& p : corner[1]) CHECK(p.x == 1.0);
  const auto gap = smooth_intervals({{0.0, 0.0}, {std::nan(""), 0.0}, {1.0, 1.0}, {2.0, 2.0}}, {1.0, 1.0});
  CHECK(gap[0].size() == 2);
  CHECK(gap[1].size() == 2);
  CHECK(smooth_intervals({{0.0, 0.0}, {0.001, 0.0}}, {1.0, 1.0})[0].size() == 2);
  CHECK(smooth_intervals({{0.0, 0.0}}, {1.0, 1.0}).empty());
}

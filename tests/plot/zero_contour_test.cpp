#include "plot/zero_contour.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace tchat;

TEST_CASE("a straight line has its two ends, wherever it lies") {
  struct Line {
    double a, b, c;  // a x + b y = c
  };
  for (const Line& line : {Line{1.0, 0.0, 0.3}, Line{0.0, 1.0, -0.7}, Line{1.0, -2.0, 0.1}, Line{1.0, 0.0, 0.5}}) {
    const auto pieces = zero_contour([&line](double x, double y) { return line.a * x + line.b * y - line.c; },
                                     {-1.0, -1.0}, {1.0, 1.0}, 40);
    REQUIRE(pieces.size() == 1);
    CHECK(pieces[0].size() == 2);
    for (const PicturePoint& p : pieces[0]) CHECK(line.a * p.x + line.b * p.y == Approx(line.c).margin(1e-12));
    const double length = std::hypot(pieces[0][1].x - pieces[0][0].x, pieces[0][1].y - pieces[0][0].y);
    CHECK(length >= 2.0 - 1e-9);
  }
}

TEST_CASE("a circle is one closed curve") {
  const auto pieces =
      zero_contour([](double x, double y) { return x * x + y * y - 0.49; }, {-1.0, -1.0}, {1.0, 1.0}, 60);
  REQUIRE(pieces.size() == 1);
  CHECK(pieces[0].size() > 50);
  CHECK(pieces[0].front().x == pieces[0].back().x);
  for (const PicturePoint& p : pieces[0]) CHECK(std::hypot(p.x, p.y) == Approx(0.7).margin(1e-3));
}

TEST_CASE("crossing lines, several pieces, no zeros, values that are not finite") {
  const auto crossing = zero_contour([](double x, double y) { return x * y; }, {-1.0, -1.0}, {1.0, 1.0}, 31);
  CHECK(crossing.size() == 2);
  CHECK(zero_contour([](double x, double) { return std::cos(10.0 * x); }, {0.0, 0.0}, {1.0, 1.0}, 50).size() == 3);
  CHECK(zero_contour([](double, double) { return 1.0; }, {0.0, 0.0}, {1.0, 1.0}, 20).empty());
  for (const auto& piece :
       zero_contour([](double x, double) { return x < 0.0 ? std::nan("") : x - 0.5; }, {-1.0, -1.0}, {1.0, 1.0}, 20))
    for (const PicturePoint& p : piece) CHECK(p.x == Approx(0.5));
}

// Which event functions are lines in a plane of states, on the linear oscillator: wall 1 - x1, sections x2 and -x2.
#include "plot/event_surface.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

#include "base/messages.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;

namespace {

/// The nonimpacting orbit at omega = 2, alpha = 3 in closed form.
OrbitTrace sample() {
  const test::OscillatorOrbit orbit{{}, 3.0, 0.3, Eigen::Vector2d::Zero()};
  OrbitTrace trace;
  trace.name = "orbit";
  trace.parameters = {3.0, 2.0, 0.05, 0.8};
  TraceSegment segment;
  segment.states.resize(4, 50);
  for (int k = 0; k < 50; ++k) {
    segment.times.push_back(test::pi * k / 49.0);
    segment.states.col(k) = orbit.state(segment.times.back());
  }
  trace.segments.push_back(segment);
  return trace;
}

struct Ring {
  static constexpr int dimension = 3, parameters = 1, fields = 1, events = 3, jumps = 1;
  static constexpr const char* event_names[] = {"ring", "tilted", "level"};
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1], f[1] = -x[0], f[2] = x[0];
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return x[0] * x[0] + x[1] * x[1] - par[0];
    return j == 2 ? x[0] + x[2] - 3.0 : x[2] - par[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
  }
};

/// Relative velocity as the event of both directions, and one with other zeros.
struct Belt {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 3, jumps = 1;
  static constexpr const char* event_names[] = {"forward", "back", "wall"};
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1], f[1] = 1.0 - x[0] * x[0];
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 3) return 1.5 - x[0] - 0.1 * x[1];
    return j == 1 ? par[0] - x[1] : 2.0 * (x[1] - par[0]);
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

}  // namespace

TEST_CASE("the wall is a line, sections through turning points are left out unless asked for") {
  const std::vector<OrbitTrace> orbits{sample()};
  const EventSurfaces surfaces(test::linosc(), orbits, {});
  const StateWindow window{-2.0, 2.0, -3.0, 3.0};
  const auto lines = surfaces.in_plane(0, 1, window);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].event.number == 1);
  REQUIRE(!lines[0].pieces.empty());
  for (const auto& piece : lines[0].pieces)
    for (const PicturePoint& p : piece) CHECK(p.x == Approx(1.0));
  CHECK(surfaces.in_plane(2, 3, window).empty());
  CHECK(surfaces.of_state(1, -3.0, 3.0).empty());
  const auto levels = surfaces.of_state(0, -2.0, 2.0);
  REQUIRE(levels.size() == 1);
  REQUIRE(levels[0].values.size() == 1);
  CHECK(levels[0].values[0] == Approx(1.0).margin(1e-9));

  const EventSurfaces all(test::linosc(), orbits, {1, 2, 3});
  CHECK(all.in_plane(0, 1, window).size() == 2);  // x2 and -x2 are one line
  CHECK_THROWS_AS(EventSurfaces(test::linosc(), orbits, {4}), UserError);
  CHECK_THROWS_AS(EventSurfaces(test::linosc(), orbits, {0}), UserError);
}

TEST_CASE("event functions with the same zeros are one line with both names") {
  OrbitTrace a;
  a.parameters = {1.0};
  a.segments.push_back({{0.0, 1.0, 2.0}, Eigen::MatrixXd{{0.1, 0.5, 1.2}, {-0.3, 0.7, 0.4}}});
  const std::vector<OrbitTrace> orbits{a};
  const EventSurfaces surfaces(test::system_of<Belt>(), orbits, {1, 2, 3});
  const auto lines = surfaces.in_plane(0, 1, {-2.0, 2.0, -2.0, 2.0});
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].event.name == "forward, back");
  REQUIRE(!lines[0].pieces.empty());
  for (const auto& piece : lines[0].pieces)
    for (const PicturePoint& p : piece) CHECK(p.y == Approx(1.0));
  CHECK(lines[1].event.name == "wall");
  const auto levels = surfaces.of_state(1, -2.0, 2.0);
  REQUIRE(levels.size() == 1);
  CHECK(levels[0].event.name == "forward, back");
  CHECK(levels[0].values.size() == 1);
}

TEST_CASE("every orbit has its own parameters, functions of a third state are no line") {
  OrbitTrace a;
  a.parameters = {1.0};
  a.segments.push_back({{0.0, 1.0, 2.0}, Eigen::MatrixXd::Random(3, 3)});
  OrbitTrace b = a;
  b.parameters = {4.0};
  const std::vector<OrbitTrace> orbits{a, b};
  const EventSurfaces surfaces(test::system_of<Ring>(), orbits, {1, 2, 3});
  const auto lines = surfaces.in_plane(0, 1, {-3.0, 3.0, -3.0, 3.0});
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].event.name == "ring");
  for (const double radius : {1.0, 2.0}) {
    std::set<int> eighths;
    for (const auto& piece : lines[0].pieces)
      for (const PicturePoint& p : piece)
        if (std::hypot(p.x, p.y) == Approx(radius).margin(1e-3))
          eighths.insert(static_cast<int>(std::floor(std::atan2(p.y, p.x) / (test::pi / 4.0))));
    CHECK(eighths.size() >= 8);
  }
  CHECK(surfaces.in_plane(0, 2, {-3.0, 3.0, -5.0, 5.0}).size() == 2);  // tilted and level
  const auto levels = surfaces.of_state(2, -1.0, 5.0);
  REQUIRE(levels.size() == 1);
  CHECK(levels[0].values.size() == 2);
}

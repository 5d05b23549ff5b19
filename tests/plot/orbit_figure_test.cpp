// Orbits with jumps as phase portraits and time series, from solutions made by hand.
#include "plot/orbit_figure.hpp"

#include <catch2/catch.hpp>

#include "constants/user_error.hpp"
#include "plot/multiplier_figure.hpp"
#include "start/temporary_folder.hpp"

using namespace tchat;
using test_support::message_of;

namespace {

/// Two segments of three states: the first ends in a jump of the second state, the second goes on smoothly.
LabelledSolution solution() {
  LabelledSolution s;
  s.problem_type = 180;
  s.dimension = 3;
  s.label = 7;
  s.type = 7;
  s.mesh_intervals = 2;
  s.collocation_points = 2;
  s.tau = {0.0, 0.25, 0.5, 0.75, 1.0};
  s.states.resize(6, 5);
  for (int k = 0; k < 5; ++k) {
    const double t = s.tau[static_cast<std::size_t>(k)];
    s.states.col(k) << t, 1.0 - 2.0 * t, 0.0, 1.0 - t, 1.0, 0.0;
  }
  s.states.row(4).setConstant(1.0);
  s.parameters.assign(100, 0.0);
  s.parameters[0] = 3.5;
  s.parameters[60] = 2.0;
  s.parameters[61] = 1.0;
  s.free_parameters = {1, 61, 62};
  return s;
}

}  // namespace

TEST_CASE("an orbit in physical time") {
  const OrbitTrace trace = orbit_trace(solution(), "PD1", 0, "q.x");
  REQUIRE(trace.segments.size() == 2);
  CHECK(trace.dimension() == 3);
  CHECK(trace.period() == 3.0);
  CHECK(trace.segments[1].times[2] == 2.5);
  CHECK(trace.jumps_after(0));
  CHECK_FALSE(trace.jumps_after(1));
  REQUIRE(trace.free_parameters.size() == 1);
  CHECK(trace.free_parameters[0].second == 3.5);
}

TEST_CASE("solutions of other programs: the dimension, or the period in PAR(11)") {
  LabelledSolution old = solution();
  old.dimension = 0;
  old.free_parameters.clear();
  CHECK(message_of<UserError>([&] { orbit_trace(old, "1", 0, "q.x"); }).find("--dimension") != std::string::npos);
  CHECK(orbit_trace(old, "1", 2, "q.x").segments.size() == 3);
  CHECK_THROWS_AS(orbit_trace(old, "1", 4, "q.x"), UserError);
  LabelledSolution smooth = solution();
  smooth.problem_type = 2;
  smooth.dimension = 6;
  smooth.parameters[10] = 5.0;
  CHECK(orbit_trace(smooth, "1", 0, "s.x").period() == 5.0);
  LabelledSolution point = solution();
  point.tau = {0.0};
  CHECK_THROWS_AS(orbit_trace(point, "1", 0, "s.x"), UserError);
}

TEST_CASE("phase portrait: jumps dashed between a filled and an open circle") {
  OrbitFigureOptions options;
  options.states = {"x1", "x2", "y"};
  options.parameters = {"alpha"};
  const Figure figure = phase_portrait({orbit_trace(solution(), "PD1", 0, "q.x")}, options);
  const Panel& panel = figure.panels[0];
  CHECK(panel.x.label.text == "x_{1}");
  CHECK(panel.y.label.text == "x_{2}");
  REQUIRE(panel.curves.size() == 3);
  CHECK(panel.curves[1].stroke.dash == Dash::dashed);
  CHECK(panel.curves[1].points.front().y == -1.0);
  CHECK(panel.curves[1].points.back().y == 1.0);
  REQUIRE(panel.markers.size() == 2);
  CHECK(panel.markers[0].filled != panel.markers[1].filled);
  for (const Marker& marker : panel.markers) CHECK(marker.at.y == (marker.filled ? -1.0 : 1.0));
  REQUIRE(figure.key.size() == 1);
  CHECK(figure.key[0].text.text == "PD1: α = 3.5");

  options.x = "y";
  options.y = {"U(1)"};
  CHECK(phase_portrait({orbit_trace(solution(), "PD1", 0, "q.x")}, options).panels[0].y.label.text == "x_{1}");
  options.x = "z";
  CHECK(message_of<UserError>([&] {
          phase_portrait({orbit_trace(solution(), "1", 0, "q")}, options);
        }).find("x1, x2, y") != std::string::npos);
}

TEST_CASE("several orbits differ in dash and colour") {
  const OrbitTrace trace = orbit_trace(solution(), "PD1", 0, "q.x");
  const Figure figure = phase_portrait({trace, trace}, {});
  REQUIRE(figure.key.size() == 2);
  CHECK(figure.key[0].stroke->dash != figure.key[1].stroke->dash);
  CHECK(figure.key[0].stroke->colour != figure.key[1].stroke->colour);
}

TEST_CASE("time series: a panel a state, or all in one") {
  OrbitFigureOptions options;
  options.states = {"x1", "x2", "y"};
  const std::vector<OrbitTrace> orbits{orbit_trace(solution(), "PD1", 0, "q.x")};
  CHECK(time_series(orbits, options).panels.size() == 2);
  options.y = {"x1", "x2", "y"};
  CHECK(time_series(orbits, options).panels.size() == 3);
  options.one_panel = true;
  const Figure one = time_series(orbits, options);
  REQUIRE(one.panels.size() == 1);
  CHECK(one.key.size() == 3);
  CHECK(one.panels[0].curves.front().points.back().x == 2.0);
}

TEST_CASE("multipliers: open where unstable, far ones counted, none at all refused") {
  DiagnosticPoint stable, unstable;
  stable.point = -1;
  stable.multipliers = {{0.5, 0.5}, {0.5, -0.5}};
  unstable.point = 2;
  unstable.type = "PD";
  unstable.multipliers = {{-1.0, 0.0}, {1e99, 0.0}, {-4.0, 0.0}};
  const Figure figure = multiplier_figure({{"a", {stable, unstable}}}, {});
  const auto& markers = figure.panels[0].markers;
  REQUIRE(markers.size() == 3);
  CHECK(markers[0].filled);
  CHECK_FALSE(markers[2].filled);
  CHECK(markers[2].label.text == "PD");
  CHECK(figure.note.text.find("2 multipliers") != std::string::npos);
  CHECK_THROWS_AS(multiplier_figure({{"a", {DiagnosticPoint{}}}}, {}), UserError);
}

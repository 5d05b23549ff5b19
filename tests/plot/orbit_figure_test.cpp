// Orbits with jumps as phase portraits and time series, from solutions made by hand.
#include "plot/orbit_figure.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <set>

#include "base/messages.hpp"
#include "files/orbit_trace.hpp"
#include "plot/multiplier_figure.hpp"
#include "support/temporary_folder.hpp"

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

TEST_CASE("phase portrait: jumps thin between a filled and an open circle") {
  OrbitFigureOptions options;
  options.states = {"x1", "x2", "y"};
  options.parameters = {"alpha"};
  const Figure figure = phase_portrait({orbit_trace(solution(), "PD1", 0, "q.x")}, options);
  const Panel& panel = figure.panels[0];
  CHECK(panel.x.label.text == "x_{1}");
  CHECK(panel.y.label.text == "x_{2}");
  REQUIRE(panel.curves.size() == 3);
  CHECK(panel.curves[1].stroke.dash == Dash::solid);
  CHECK(panel.curves[1].stroke.width < 0.7 * panel.curves[0].stroke.width);
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

TEST_CASE("several orbits differ in colour and symbol, dashes say unstable") {
  const OrbitTrace trace = orbit_trace(solution(), "PD1", 0, "q.x");
  std::vector<OrbitTrace> orbits{trace, trace, trace};
  orbits[1].kind = LineKind::unstable;
  orbits[2].kind = LineKind::inadmissible;
  const Figure figure = phase_portrait(orbits, {});
  REQUIRE(figure.key.size() == 3);
  const Dash dashes[] = {Dash::solid, Dash::dashed, Dash::dotted};
  const std::string words[] = {"3.5", ", unstable", ", inadmissible"};
  std::set<std::string> colours;
  std::set<Symbol> symbols;
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(figure.key[k].stroke->dash == dashes[k]);
    CHECK(figure.panels[0].curves[3 * k].stroke.dash == dashes[k]);
    CHECK(figure.panels[0].curves[3 * k + 1].stroke.dash == Dash::solid);  // the jump
    CHECK(figure.key[k].text.text.ends_with(words[k]));
    colours.insert(figure.key[k].stroke->colour);
    symbols.insert(figure.key[k].marker.value().symbol);
  }
  CHECK(colours.size() == 3);
  CHECK(symbols.size() == 3);

  OrbitFigureOptions named;
  named.legend = {"a", "b", "c"};
  for (const Figure& other : {phase_portrait(orbits, named), time_series(orbits, named)}) {
    REQUIRE(other.key.size() >= 5);
    CHECK(other.key[other.key.size() - 2].text.text == "unstable");
    CHECK(other.key[other.key.size() - 2].stroke->dash == Dash::dashed);
    CHECK(other.key.back().text.text == "inadmissible");
  }
}

TEST_CASE("what a label is: the multipliers of the d-file, else the sign of the p-file") {
  const test_support::TemporaryFolder folder;
  const auto block = [](int label, const char* what, double multiplier) {
    return fmt::format(
        "  BR    PT  TY  LAB       alpha\n   1     {}  EP {:4}   1.0E+00{}\n   Multiplier   1  {} 0.0\n{}\n", label,
        label, what, multiplier, std::string(47, '='));
  };
  folder.write("p.a", "   1   1   9   1   1.0\n   1  -2   9   2   1.0\n");
  CHECK(label_kinds(folder.file("q.a")) == std::map<int, LineKind>{{1, LineKind::unstable}});
  folder.write("d.a", block(1, "", 0.5) + block(2, "", -1.0) + block(3, "", 1.5) + block(4, "  inadmissible", 0.5));
  CHECK(label_kinds(folder.file("q.a")) ==
        std::map<int, LineKind>{{3, LineKind::unstable}, {4, LineKind::inadmissible}});
  CHECK(label_kinds(folder.file("q.none")).empty());
}

TEST_CASE("three states: a portrait in space") {
  OrbitFigureOptions options;
  options.states = {"x1", "x2", "y"};
  options.x = "y", options.y = {"x1"}, options.z = "x2";
  const Panel panel = phase_portrait({orbit_trace(solution(), "PD1", 0, "q.x")}, options).panels[0];
  REQUIRE(panel.z);
  CHECK(panel.z->label.text == "x_{2}");
  const PicturePoint end = panel.curves[0].points.back();
  CHECK(end.x == 0.0);
  CHECK(end.y == 1.0);
  CHECK(end.z == -1.0);
  CHECK(panel.markers[1].at.z == -1.0);
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

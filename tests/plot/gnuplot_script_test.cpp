// The script: what gnuplot is told, text that cannot escape its quotes, equal figures give equal scripts.
#include "plot/gnuplot_script.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "base/messages.hpp"
#include "plot/figure.hpp"

using namespace tchat;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Figure sample() {
  Figure figure;
  Panel panel;
  panel.x.label = mathematical_name("alpha");
  panel.y.label = plain_text("it's `date`");
  panel.curves.push_back(
      {{{0.0, 0.0}, {1.0, 2.0}, {std::nan(""), 1.0}, {2.0, 1.0}}, {Dash::dashed, 2.0, "#123456"}, false});
  panel.markers.push_back(special_point_marker("GR", {1.0, 2.0}));
  figure.panels.push_back(panel);
  figure.key.push_back({plain_text("a_b"), Stroke{}, std::nullopt});
  figure.title = plain_text("title");
  return figure;
}

std::string script_of(const Figure& figure, const PictureTarget& target) {
  return gnuplot_script(figure, lay_out(figure), target);
}

}  // namespace

TEST_CASE("axes, data, dashes, labels and texts are in the script") {
  const std::string script = script_of(sample(), {PictureFormat::png, "x's.png", ""});
  CHECK(contains(script, "set terminal pngcairo"));
  CHECK(contains(script, "size 1200,900"));
  CHECK(contains(script, R"(set output "x\047s.png")"));
  CHECK(contains(script, "set xlabel 'α' enhanced"));
  CHECK(contains(script, R"(set ylabel "it\047s \140date\140" noenhanced)"));
  CHECK(contains(script, "$curve1_1 << END\n0 0\n1 2\n\n2 1\nEND\n"));
  CHECK(contains(script, "dt (14,8) lw 2 lc rgb '#123456'"));
  CHECK(contains(script, "set label 'GR' noenhanced at screen"));
  CHECK(contains(script, "set label 'a_b' noenhanced"));
  CHECK(contains(script, "'title' noenhanced"));
  CHECK(script == script_of(sample(), {PictureFormat::png, "x's.png", ""}));
}

TEST_CASE("a name of a file is a name: no command, no home folder, no line of its own") {
  CHECK(contains(script_of(sample(), {PictureFormat::png, "|cat.png", ""}), "set output './|cat.png'"));
  CHECK(contains(script_of(sample(), {PictureFormat::png, "~a.png", ""}), "set output './~a.png'"));
  CHECK(contains(script_of(sample(), {PictureFormat::png, "a.png", ""}), "set output 'a.png'"));
  CHECK_THROWS_AS(script_of(sample(), {PictureFormat::png, "a\n!touch b\n.png", ""}), UserError);
  Figure figure = sample();
  figure.title = {"a\nsystem 'b'", false};
  CHECK_THROWS_AS(script_of(figure, {PictureFormat::png, "a.png", ""}), UserError);
}

TEST_CASE("every form of picture has its terminal") {
  CHECK(picture_format("a.PNG") == PictureFormat::png);
  CHECK(contains(script_of(sample(), {picture_format("a.svg"), "a.svg", ""}), "set terminal svg"));
  CHECK(contains(script_of(sample(), {picture_format("a.pdf"), "a.pdf", ""}), "size 8.000in,6.000in"));
  const std::string window = script_of(sample(), {PictureFormat::window, "", "qt"});
  CHECK(contains(window, "set terminal qt"));
  CHECK_FALSE(contains(window, "set output"));
  CHECK(window_terminal({"png", "x11", "qt"}) == "qt");
  CHECK(window_terminal({"png", "x11"}) == "x11");
  CHECK(window_terminal({"png"}).empty());
  for (const char* path : {"a", "a.jpg", "a.", ""}) CHECK_THROWS_AS(picture_format(path), UserError);
}

TEST_CASE("what is placed is inside the picture") {
  Figure figure = sample();
  for (const auto& [width, height] : {std::pair(1200, 900), {300, 200}, {4000, 700}, {100, 100}}) {
    figure.width = width;
    figure.height = height;
    const FigureLayout layout = lay_out(figure);
    const Box& frame = layout.panels[0].frame;
    CHECK(frame.left >= 0.0);
    CHECK(frame.right <= width);
    CHECK(frame.bottom >= 0.0);
    CHECK(frame.top <= height);
    const PicturePoint p = layout.panels[0].in_data(layout.panels[0].on_paper({1.0, 2.0}));
    CHECK(p.x == Approx(1.0));
    CHECK(p.y == Approx(2.0));
  }
}

TEST_CASE("equal points side by side share a label, the key hides nothing") {
  Figure figure;
  Panel panel;
  Curve curve;
  for (int k = 0; k <= 200; ++k) curve.points.push_back({k / 200.0, 1.0 - k / 200.0});
  panel.curves.push_back(curve);
  for (int k = 0; k < 40; ++k)
    panel.markers.push_back(special_point_marker("XI", {0.5 + 0.0005 * k, 0.5 - 0.0005 * k}));
  panel.markers.push_back(special_point_marker("GR", {0.5, 0.5}));
  figure.panels.push_back(panel);
  figure.key.push_back({plain_text("stable"), Stroke{}, std::nullopt});
  const FigureLayout layout = lay_out(figure);
  int xi = 0;
  for (std::size_t k = 0; k + 1 < layout.panels[0].labels.size(); ++k) xi += layout.panels[0].labels[k].has_value();
  CHECK(xi >= 1);
  CHECK(xi <= 2);
  CHECK(layout.panels[0].labels.back().has_value());
  REQUIRE(layout.key);
  CHECK(layout.key->inside);
  for (const PicturePoint& p : curve.points) CHECK_FALSE(layout.key->box.contains(layout.panels[0].on_paper(p)));
}

TEST_CASE("dashes of a short piece are shorter, the symbol at its end is smaller, no label on it") {
  Figure figure;
  Panel panel;
  const Stroke unstable{Dash::dashed, 2.0, "#000000"};
  panel.curves.push_back({{{0.0, 0.0}, {1.0, 1.0}}, Stroke{}, false});
  panel.curves.push_back({{{1.0, 1.0}, {1.02, 1.0}}, unstable, false});
  panel.curves.push_back({{{0.0, 0.5}, {1.0, 0.5}}, unstable, false});
  panel.markers.push_back(special_point_marker("LP", {1.0, 1.0}));
  panel.markers.push_back(special_point_marker("PD", {0.5, 0.5}));
  figure.panels.push_back(panel);
  const FigureLayout layout = lay_out(figure);
  const PanelLayout& place = layout.panels[0];
  CHECK(place.dash_scales[1] < 0.7);
  CHECK(place.dash_scales[2] == 1.0);
  CHECK(place.marker_scales[0] < 1.0);
  CHECK(place.marker_scales[1] == 1.0);
  REQUIRE(place.labels[0]);
  CHECK(length_inside(place.labels[0]->box, place.on_paper({1.0, 1.0}), place.on_paper({1.02, 1.0})) == 0.0);
  const std::string script = script_of(figure, {PictureFormat::png, "x.png", ""});
  CHECK(contains(script, "dt (14,8)"));
  CHECK(script.find("dt (") != script.rfind("dt ("));
}

TEST_CASE("a panel in space: three coordinates, three axes, no place for labels") {
  Figure figure;
  Panel panel;
  panel.z = AxisSettings{mathematical_name("y1"), {}, {}, false};
  panel.curves.push_back({{{0.0, 0.0, 1.0}, {1.0, 2.0, 3.0}}, Stroke{}, false});
  panel.arrows.push_back({{0.0, 0.0, 1.0}, {1.0, 2.0, 3.0}, "#000000"});
  figure.panels.push_back(panel);
  figure.key.push_back({plain_text("orbit"), Stroke{}, std::nullopt});
  const std::string script = script_of(figure, {PictureFormat::png, "x.png", ""});
  CHECK(contains(script, "$curve1_1 << END\n0 0 1\n1 2 3\nEND\n"));
  CHECK(contains(script, "splot $curve1_1 with lines"));
  CHECK(contains(script, "set zlabel 'y_{1}' enhanced"));
  CHECK(contains(script, "set arrow from 0,0,1 to 1,2,3 head"));
  CHECK(contains(script, "set view 65,35"));
}

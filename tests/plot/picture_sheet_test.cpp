// Panels side by side: frames in rows and columns, common ranges, one script; maps and bars of colours; large clouds.
#include "plot/picture_sheet.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "plot/gnuplot_script.hpp"

using namespace tchat;
using Catch::Matchers::Contains;

namespace {

Figure line(double height, const char* title = "") {
  Figure figure;
  figure.panels.emplace_back();
  figure.panels[0].x.label = figure.panels[0].y.label = plain_text("v");
  figure.panels[0].curves.push_back({{{0.0, 0.0}, {1.0, height}}, {}});
  figure.title = plain_text(title);
  return figure;
}

Figure coloured() {
  Figure figure;
  figure.panels.emplace_back();
  ColourField field;
  field.columns = 3, field.rows = 2;
  field.first = {0.0, 10.0}, field.last = {2.0, 20.0};
  field.cells = {-2, 1, std::nan(""), 1, 1, 0};
  figure.panels[0].field = field;
  figure.palette = Palette{{{-2.0, "#112233"}, {6.0, "#445566"}}, plain_text("depth")};
  return figure;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("two panels: frames of one height side by side, whatever stands above or beside one of them") {
  Sheet sheet;
  sheet.figures = {line(1.0, "with a title"), line(123456.0)};
  sheet.columns = 2;
  sheet.width = 1600, sheet.height = 650;
  const SheetLayout layout = lay_out(sheet);
  REQUIRE(layout.figures.size() == 2);
  const Box& left = layout.figures[0].layout.panels[0].frame;
  const Box& right = layout.figures[1].layout.panels[0].frame;
  CHECK(left.top == right.top);
  CHECK(left.bottom == right.bottom);
  CHECK(layout.figures[1].left == 800.0);
  CHECK(left.right < 800.0);
  const std::string script = gnuplot_script(layout, {PictureFormat::svg, "a.svg", ""});
  CHECK(contains(script, "size 1600,650"));
  CHECK(contains(script, "set multiplot"));
  CHECK(contains(script, "plot $curve1_1 "));
  CHECK(contains(script, "plot $curve2_1 "));
  CHECK(contains(script, fmt::format("set lmargin at screen {:.5f}", (800.0 + right.left) / 1600.0)));
}

TEST_CASE("four panels make two rows, whose left edges agree") {
  Sheet sheet;
  sheet.figures = {line(1.0), line(1.0), line(123456.0), line(1.0)};
  sheet.columns = columns_for(4);
  sheet.width = 1600, sheet.height = 1300;
  sheet.title = plain_text("all of them");
  const SheetLayout layout = lay_out(sheet);
  CHECK(layout.figures[0].layout.panels[0].frame.left == layout.figures[2].layout.panels[0].frame.left);
  CHECK(layout.figures[2].bottom == 0.0);
  CHECK(layout.figures[0].bottom == Approx(layout.figures[0].figure.height).margin(1.0));
  CHECK(contains(gnuplot_script(layout, {PictureFormat::png, "a.png", ""}), "set label 'all of them'"));
  CHECK(columns_for(1) == 1);
  CHECK(columns_for(3) == 3);
  CHECK(columns_for(6) == 3);
}

TEST_CASE("the same ranges: of all panels together, but for ends that the user has chosen") {
  Sheet sheet;
  sheet.figures = {line(1.0), line(10.0)};
  sheet.columns = 2;
  sheet.same_ranges = true;
  sheet.figures[1].panels[0].y.low = -3.0;
  const SheetLayout layout = lay_out(sheet);
  const PanelLayout &a = layout.figures[0].layout.panels[0], &b = layout.figures[1].layout.panels[0];
  CHECK(a.y.high == Approx(10.4));
  CHECK(b.y.high == Approx(10.4));
  CHECK(a.y.low == -3.0);
  CHECK(b.y.low == -3.0);
  CHECK(a.x.low == b.x.low);
}

TEST_CASE("a logarithmic panel leaves nothing to the next one") {
  Sheet sheet;
  sheet.figures = {line(1.0), line(1.0)};
  sheet.columns = 2;
  sheet.figures[0].panels[0].curves[0].points[0] = {0.1, 0.1};
  sheet.figures[0].panels[0].y.logarithmic = true;
  const std::string script = gnuplot_script(lay_out(sheet), {PictureFormat::png, "a.png", ""});
  CHECK(script.find("unset logscale") > script.find("set logscale y"));
  CHECK(contains(script, "unset logscale"));
}

TEST_CASE("one figure is what it was without a sheet") {
  const Figure figure = line(2.0, "alone");
  Sheet sheet;
  sheet.figures = {figure};
  const PictureTarget target{PictureFormat::pdf, "a.pdf", ""};
  CHECK(gnuplot_script(lay_out(sheet), target) == gnuplot_script(figure, lay_out(figure), target));
  sheet.figures = {figure, figure};
  sheet.figures[1].panels[0].z = AxisSettings{};
  CHECK_THROWS_WITH(lay_out(sheet), Contains("in space"));
}

TEST_CASE("a map fills its frame, its cells and colours are in the script, and the bar has tics and a text") {
  const Figure figure = coloured();
  const FigureLayout layout = lay_out(figure);
  CHECK(layout.panels[0].x.low == -0.5);
  CHECK(layout.panels[0].x.high == 2.5);
  CHECK(layout.panels[0].y.low == 5.0);
  CHECK(layout.panels[0].y.high == 25.0);
  REQUIRE(layout.colour_bar);
  CHECK(layout.colour_bar->box.left > layout.panels[0].frame.right);
  CHECK(layout.colour_bar->box.bottom == Approx(layout.panels[0].frame.bottom));
  const std::string script = gnuplot_script(figure, layout, {PictureFormat::png, "a.png", ""});
  CHECK(contains(script, "$field1 << END\n-2 1 nan\n1 1 0\nEND\n"));
  CHECK(contains(script, "set palette defined (-2 '#112233', 6 '#445566')"));
  CHECK(contains(script, "set cbrange [-2:6]"));
  CHECK(contains(script, "$field1 matrix using (0+(1)*$1):(10+(10)*$2):3 with image"));
  CHECK(contains(script, "set label 'depth'"));
  CHECK(contains(script, "set colorbox vertical user"));
}

TEST_CASE("of a large cloud one dot stays in each small square, and none outside") {
  const Figure figure = line(1.0);
  const PanelLayout panel = lay_out(figure).panels[0];
  std::vector<PicturePoint> points;
  for (int k = 0; k < 100000; ++k) points.push_back({0.5 + 0.25 * std::sin(k), 0.5 + 0.25 * std::cos(k)});
  points.push_back({5.0, 0.5});
  points.push_back({std::nan(""), 0.5});
  const auto kept = thinned_points(points, panel, 2.0);
  CHECK(kept.size() < 2000);
  CHECK(kept.size() > 400);  // a circle of some hundred pixels
  for (const PicturePoint& p : kept) CHECK(p.x <= 1.0);
  for (std::size_t k = 0; k < points.size(); k += 997) {  // and each dot that is gone has one nearby
    if (!panel.frame.contains(panel.on_paper(points[k]))) continue;
    const PicturePoint at = panel.on_paper(points[k]);
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const PicturePoint& p) {
      const PicturePoint other = panel.on_paper(p);
      return std::abs(other.x - at.x) < 2.0 && std::abs(other.y - at.y) < 2.0;
    });
    CHECK(near);
  }
  CHECK(thinned_points({{9.0, 9.0}, {std::nan(""), 1.0}}, panel, 2.0).size() == 1);
}

// What a sweep becomes in a picture: rows chosen, columns and expressions of them, dots and their colours, bars, maps.
#include "plot/underlay.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "base/messages.hpp"
#include "plot/figure.hpp"
#include "plot/sweep_columns.hpp"
#include "support/temporary_folder.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using test_support::message_of;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

SweptQuantity over(const std::string& name, double from, double to, long count, bool is_state = false) {
  SweptQuantity quantity;
  quantity.name = name;
  quantity.from = from, quantity.to = to, quantity.count = count, quantity.is_state = is_state;
  return quantity;
}

/// Three values of mu, two states recorded at each, with an exponent.
SweepFile dots() {
  SweepFile file{"a.sweep", "a", {}};
  file.table.over = {over("mu", 1.0, 3.0, 3)};
  file.table.parameters = {{"m", 0.5}};
  file.table.starts = {"x = (0,0)"};
  file.table.names = {"index", "mu", "start", "attractor", "lambda1", "error1", "x1", "x2"};
  file.table.columns = {{0, 0, 1, 1, 2, 2},
                        {1, 1, 2, 2, 3, 3},
                        {1, 1, 1, 1, 1, 1},
                        {1, 1, 2, 2, 2, 2},
                        {-1, -1, 0.5, 0.5, 0.75, 0.75},
                        {0.1, 0.1, 0.2, 0.2, nan, nan},
                        {10, 11, 20, 21, 30, 31},
                        {-10, -11, -20, -21, nan, -31}};
  file.table.kinds = {AttractorKind::periodic, AttractorKind::periodic, AttractorKind::chaotic,
                      AttractorKind::chaotic,  AttractorKind::chaotic,  AttractorKind::chaotic};
  return file;
}

/// A map of 3 x 2 values: what was swept first runs fastest.
SweepFile map() {
  SweepFile file{"b.sweep", "b", {}};
  file.table.over = {over("x1", -1.0, 1.0, 3, true), over("m", 0.25, 0.75, 2)};
  file.table.starts = {"x = (0,0)"};
  file.table.names = {"index", "x1(0)", "m", "start", "attractor", "period", "penetration"};
  file.table.columns = {{0, 1, 2, 3, 4, 5},   {-1, 0, 1, -1, 0, 1}, {0.25, 0.25, 0.25, 0.75, 0.75, 0.75},
                        {1, 1, 1, 1, 1, 1},   {1, 1, 0, 2, 2, 1},   {2, 2, nan, 5, 5, 2},
                        {-1, 0, 1, 2, 3, nan}};
  file.table.kinds.assign(6, AttractorKind::periodic);
  file.table.kinds[2] = AttractorKind::escape;
  SweepAttractor one, two;
  one.number = 1, one.kind = AttractorKind::periodic, one.impacts = 1, one.period = 6.25;
  two.number = 2, two.kind = AttractorKind::periodic, two.impacts = 3, two.period = 12.5;
  file.table.attractors = {one, two};
  return file;
}

Underlay layer(const SweepFile& file, const SweepLook& look = {}) {
  std::vector<std::string> warnings;
  return sweep_layer(file, look, warnings);
}

SweepLook with(const std::string& x, const std::string& y, const std::string& z = "") {
  SweepLook look;
  look.x = x, look.y = y, look.z = z;
  return look;
}

std::vector<std::pair<double, double>> places(const Cloud& cloud) {
  std::vector<std::pair<double, double>> list;
  for (const PicturePoint& p : cloud.points) list.emplace_back(p.x, p.y);
  return list;
}

}  // namespace

TEST_CASE("a sweep over one quantity: its first recorded state, a dot a row") {
  const Underlay picture = layer(dots());
  REQUIRE(picture.clouds.size() == 1);
  CHECK(places(picture.clouds[0]) ==
        std::vector<std::pair<double, double>>{{1, 10}, {1, 11}, {2, 20}, {2, 21}, {3, 30}, {3, 31}});
  CHECK(picture.x.text == "μ");
  CHECK(picture.y.text == "x_{1}");
  CHECK(picture.clouds[0].colour == "#000000");
  CHECK_FALSE(picture.field);
}

TEST_CASE("columns, parameters that are not swept, expressions and later rows") {
  const SweepFile file = dots();
  CHECK(places(layer(file, with("", "X2")).clouds[0]).size() == 5);  // a value that is none has no dot
  CHECK(places(layer(file, with("mu - 1", "m*x1 + 1/2")).clouds[0])[2] == std::pair(1.0, 10.5));
  const Underlay next = layer(file, with("x1", "x1@+1"));
  CHECK(places(next.clouds[0]) == std::vector<std::pair<double, double>>{{10, 11}, {20, 21}, {30, 31}});
  CHECK(next.y.text == "x_{1}, next");
  CHECK(places(layer(file, with("mu", "x1@+1-x1")).clouds[0])[1] == std::pair(2.0, 1.0));
  CHECK_THROWS_WITH(layer(file, with("", "x1@+2")), Contains("nowhere a number"));
  CHECK_THROWS_WITH(layer(file, with("", "y1")),
                    Contains("a.sweep: -y 'y1'") && Contains("mu, start") && Contains("kind, m"));
  CHECK_THROWS_WITH(layer(file, with("1/omega", "")), Contains("'omega'") && Contains("-x"));
}

TEST_CASE("quantities of a value are one dot, exponents with their bars and a line at zero") {
  const Underlay picture = layer(dots(), with("", "lambda1"));
  CHECK(places(picture.clouds[0]) == std::vector<std::pair<double, double>>{{1, -1}, {2, 0.5}, {3, 0.75}});
  REQUIRE(picture.curves.size() == 2);
  CHECK(picture.curves[0].background);  // zero
  CHECK(picture.curves[0].points[1].x == 3.0);
  const auto& bars = picture.curves[1].points;  // two: the third has none
  REQUIRE(bars.size() == 6);
  CHECK(bars[0].y == Approx(-1.1));
  CHECK(bars[1].y == Approx(-0.9));
  CHECK(std::isnan(bars[2].y));
  CHECK(bars[4].y == Approx(0.7));
  CHECK(picture.y.text == "λ_{1}");
}

TEST_CASE("several quantities along y: a colour and a line of the key for each") {
  const Underlay picture = layer(dots(), with("", "x1,x2"));
  REQUIRE(picture.clouds.size() == 2);
  CHECK(picture.clouds[0].colour != picture.clouds[1].colour);
  REQUIRE(picture.key.size() == 2);
  CHECK(picture.key[1].text.text == "x_{2}");
  CHECK(places(layer(dots(), with("", "atan2(x1,x1)")).clouds[0])[0].second == Approx(std::atan(1.0)));
}

TEST_CASE("colours tell attractors and kinds apart, numbers have a scale") {
  const Underlay attractors = layer(dots(), with("", "", "attractor"));
  REQUIRE(attractors.clouds.size() == 2);
  CHECK(attractors.clouds[0].points.size() == 2);
  CHECK(attractors.clouds[1].points.size() == 4);
  const Underlay kinds = layer(dots(), with("", "", "kind"));
  REQUIRE(kinds.key.size() == 2);
  CHECK(kinds.key[0].text.text == "periodic");
  CHECK(kinds.key[1].text.text == "chaotic");
  const Underlay scale = layer(dots(), with("", "", "x1"));
  REQUIRE(scale.palette);
  CHECK(scale.key.empty());
  CHECK(scale.palette->low() == 10.0);
  CHECK(scale.palette->high() == 31.0);
  REQUIRE(scale.clouds.size() == 1);
  CHECK(scale.clouds[0].colour == "palette");
  CHECK(scale.clouds[0].points.size() == 6);
  CHECK(scale.clouds[0].points.front().z == 10.0);
  CHECK(scale.clouds[0].points.back().z == 31.0);
}

TEST_CASE("sweeps up and down have a colour each, the first with larger dots beneath") {
  SweepFile file = dots();
  file.table.starts = {"up from x = (0,0)", "down from x = (0,0)"};
  file.table.columns[2] = {1, 2, 1, 2, 1, 2};
  const Underlay picture = layer(file);
  REQUIRE(picture.clouds.size() == 2);
  CHECK(places(picture.clouds[0]) == std::vector<std::pair<double, double>>{{1, 10}, {2, 20}, {3, 30}});
  CHECK(picture.clouds[0].size > picture.clouds[1].size);
  CHECK(picture.key[0].text.text == "up");
  CHECK(picture.key[1].text.text == "down");
  SweepLook look;
  look.grey = true;
  std::vector<std::string> warnings;
  const Underlay grey = sweep_layer(file, look, warnings);
  REQUIRE(grey.clouds.size() == 1);
  CHECK(grey.clouds[0].points.size() == picture.clouds[0].points.size() + picture.clouds[1].points.size());
  file.table.starts = {"x = (0,0)", "x = (1,0)"};
  CHECK(layer(file).clouds.size() == 1);
}

TEST_CASE("a map over two quantities: a cell for each value, in the colour of its attractor") {
  const Underlay picture = layer(map());
  REQUIRE(picture.field);
  const ColourField& field = *picture.field;
  CHECK(field.columns == 3);
  CHECK(field.rows == 2);
  CHECK(field.first.x == -1.0);
  CHECK(field.last.y == 0.75);
  CHECK(field.low().x == -1.5);
  CHECK(field.high().y == 1.0);
  const double none = 2;
  CHECK(field.cells == std::vector<double>{0, 0, none, 1, 1, 0});
  REQUIRE(picture.key.size() == 3);
  CHECK(picture.key[0].text.text == "1: 1 impact, period 6.25");
  CHECK(picture.key[1].text.text == "2: 3 impacts, period 12.5");
  CHECK(picture.key[2].text.text == "no attractor");
  CHECK(picture.x.text == "x_{1}(0)");
  CHECK(picture.y.text == "m");
}

TEST_CASE("a map turned: the second swept quantity along x") {
  const ColourField field = *layer(map(), with("m", "")).field;
  CHECK(field.columns == 2);
  CHECK(field.rows == 3);
  CHECK(field.cells == std::vector<double>{0, 1, 0, 1, 2, 0});
}

TEST_CASE("maps of periods and of a number") {
  const Underlay periods = layer(map(), with("", "", "period"));
  REQUIRE(periods.key.size() == 3);
  CHECK(periods.key[0].text.text == "period 2");
  CHECK(periods.key[1].text.text == "period 5");
  CHECK(periods.key[2].text.text == "not periodic");
  const Underlay depth = layer(map(), with("", "", "penetration"));
  REQUIRE(depth.palette);
  CHECK(depth.field->cells.front() == depth.palette->low());
  CHECK(depth.field->cells[4] == depth.palette->high());
  CHECK(std::isnan(depth.field->cells[5]));  // nothing is known there
  SweepLook look = with("", "", "penetration");
  look.z_low = 0.0, look.z_high = 1.0;
  CHECK(layer(map(), look).palette->high() == 1.0);
  CHECK_THROWS_WITH(layer(map(), with("", "", "nosuch")), Contains("-z 'nosuch'"));
}

TEST_CASE("a chosen value: the nearest one, with a warning where it is another") {
  std::vector<std::string> warnings;
  SweepLook look;
  look.choices = {read_sweep_choice("m=0.6")};
  const Underlay line = sweep_layer(map(), look, warnings);  // what is left free is along x, the penetration along y
  CHECK(places(line.clouds[0]) == std::vector<std::pair<double, double>>{{-1, 2}, {0, 3}});
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("nearest to 0.6 is 0.75"));
  warnings.clear();
  look.choices = {read_sweep_choice("m=0.25"), read_sweep_choice("attractor=1")};
  CHECK(places(sweep_layer(map(), look, warnings).clouds[0]) ==
        std::vector<std::pair<double, double>>{{-1, -1}, {0, 0}});
  CHECK(warnings.empty());
  for (const auto& [text, part] :
       {std::pair("m=2", "goes from 0.25 to 0.75"), {"start=7", "no row"}, {"q=1", "no column"}}) {
    look.choices = {read_sweep_choice(text)};
    CHECK_THROWS_WITH(sweep_layer(map(), look, warnings), Contains(part));
  }
  for (const char* text : {"m", "m=", "m=a", "=1", "m=nan"}) {
    INFO(text);
    CHECK_THROWS_WITH(read_sweep_choice(text), Contains("--at mu=-0.8"));
  }
}

TEST_CASE("of several starts a map shows one, and says so") {
  SweepFile file = map();
  for (auto& column : file.table.columns) {
    const std::vector<double> once = column;
    column.insert(column.end(), once.begin(), once.end());
  }
  for (std::size_t k = 6; k < 12; ++k) file.table.columns[3][k] = 2, file.table.columns[4][k] = 2;
  const std::vector<AttractorKind> kinds = file.table.kinds;
  file.table.kinds.insert(file.table.kinds.end(), kinds.begin(), kinds.end());
  std::vector<std::string> warnings;
  CHECK(sweep_layer(file, {}, warnings).field->cells[3] == 1);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("start 1") && Contains("--at start=N"));
  SweepLook look;
  look.choices = {read_sweep_choice("start=2")};
  CHECK(sweep_layer(file, look, warnings).field->cells == std::vector<double>(6, 0));
}

TEST_CASE("more attractors than colours: the most frequent ones, then the others") {
  SweepFile file{"c.sweep", "c", {}};
  file.table.over = {over("a", 0, 29, 30)};
  file.table.names = {"index", "a", "attractor"};
  file.table.columns.resize(3);
  for (int k = 0; k < 30; ++k) {
    file.table.columns[0].push_back(k), file.table.columns[1].push_back(k);
    file.table.columns[2].push_back(k < 10 ? 20 : k);  // number 20 ten times and once more
  }
  file.table.kinds.assign(30, AttractorKind::chaotic);
  std::vector<std::size_t> rows(30);
  for (std::size_t k = 0; k < 30; ++k) rows[k] = k;
  const RowColours colours = row_colours(file.table, "c.sweep", {"attractor", {}, {}, {}}, rows);
  REQUIRE(colours.names.size() == 12);
  CHECK(colours.names.back().text == "others");
  CHECK(colours.names[static_cast<std::size_t>(colours.numbers[0])].text == "20");
  CHECK(std::count(colours.numbers.begin(), colours.numbers.end(), 11) == 9);
}

TEST_CASE("two maps in one panel are refused") {
  Underlay one = layer(map());
  CHECK_THROWS_WITH(one.add(layer(map())), Contains("--panel"));
}

TEST_CASE("scales of colours: the ends, and grey in the middle of signed ones") {
  const Palette rising = scale_palette(1.0, 2.0);
  CHECK(colour_at(rising, 1.0) == "#440154");
  CHECK(colour_at(rising, 2.0) == "#fde725");
  const Palette of_both_signs = scale_palette(-1.0, 3.0);
  CHECK(of_both_signs.low() == -1.0);
  CHECK(of_both_signs.high() == 3.0);
  CHECK(colour_at(of_both_signs, 0.0) == "#eeeeee");
  CHECK(colour_at(of_both_signs, -1.0) == "#9fc1db");
  CHECK(colour_at(cyclic_palette(), 0.0) == colour_at(cyclic_palette(), 1.0));
}

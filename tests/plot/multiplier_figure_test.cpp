// Multipliers in the plane: what dots mean stands in the key.
#include "plot/multiplier_figure.hpp"

#include <catch2/catch.hpp>

#include "plot/gnuplot_script.hpp"

using namespace tchat;

namespace {

DiagnosticPoint point(int number, double mu) {
  DiagnosticPoint result;
  result.point = number;
  result.multipliers = {{mu, 0.0}, {0.1, 0.2}, {0.1, -0.2}};
  return result;
}

std::vector<std::string> texts(const Figure& figure) {
  std::vector<std::string> result;
  for (const KeyEntry& entry : figure.key) result.push_back(entry.text.text);
  return result;
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("the key of multipliers says what filled, open, black and grey dots are") {
  const Figure figure = multiplier_figure({{"a", {point(-1, 0.5), point(-2, 0.9), point(3, 1.2)}}}, {});
  CHECK(texts(figure) == Texts{"stable orbit", "unstable orbit", "black: start of the branch", "grey: its end"});
  CHECK(figure.key[0].marker->filled);
  CHECK_FALSE(figure.key[1].marker->filled);
  const std::vector<Marker>& dots = figure.panels[0].markers;
  CHECK(figure.key[2].marker->colour == dots.front().colour);
  CHECK(figure.key[3].marker->colour == dots.back().colour);
}

TEST_CASE("several series of multipliers have colours instead of shades") {
  const Figure figure = multiplier_figure({{"a", {point(-1, 0.5)}}, {"b", {point(-1, 0.7)}}}, {});
  CHECK(texts(figure) == Texts{"a", "b", "stable orbit"});
  CHECK(figure.key[0].marker->colour != figure.key[1].marker->colour);
}

TEST_CASE("at single labels the multipliers, not the sign of the point before, say what is unstable") {
  const Figure unstable = multiplier_figure({{"PD1", {point(-2, 1.08)}}}, {true, {}});
  CHECK(texts(unstable) == Texts{"unstable orbit"});
  CHECK_FALSE(unstable.panels[0].markers[0].filled);
  const Figure critical = multiplier_figure({{"PD1", {point(2, -1.0)}}}, {true, {}});
  CHECK(critical.key.empty());
  CHECK(critical.panels[0].markers[0].filled);
}

TEST_CASE("tics are drawn over curves and points") {
  const Figure figure = multiplier_figure({{"a", {point(-1, 0.5)}}}, {});
  CHECK(gnuplot_script(figure, lay_out(figure), {PictureFormat::png, "x.png", ""}).find("set tics front") !=
        std::string::npos);
}

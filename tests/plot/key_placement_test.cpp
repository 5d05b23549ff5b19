// The key: columns as wide as their texts, nothing over anything else, nothing outside the picture.
#include "plot/layout.hpp"

#include <catch2/catch.hpp>

using namespace tchat;

namespace {

constexpr double font = 27.0;

std::vector<KeyEntry> entries(const std::vector<std::string>& names) {
  std::vector<KeyEntry> result;
  for (const std::string& name : names) result.push_back({plain_text(name), Stroke{}, std::nullopt});
  return result;
}

/// Sample and text of each entry; a letter of a sans font is at least half as wide as high, an m nearly as wide.
std::vector<Box> boxes(const KeyPlace& place, const std::vector<std::string>& names) {
  std::vector<Box> result;
  for (std::size_t k = 0; k < names.size(); ++k) {
    double width = (key_sample_length + 0.5) * place.font;
    for (const char c : names[k]) width += (c == 'm' ? 0.95 : c == 'i' ? 0.28 : 0.5) * label_font_ratio * place.font;
    const PicturePoint& at = place.entries[k];
    result.push_back({at.x, at.x + width, at.y - 0.5 * place.font, at.y + 0.5 * place.font});
  }
  return result;
}

/// A figure whose curves leave no corner free for a key.
Figure crowded(const std::vector<std::string>& names) {
  Figure figure;
  Panel panel;
  for (int k = 0; k <= 30; ++k) panel.curves.push_back({{{0.0, k / 30.0}, {1.0, k / 30.0}}, {}, false});
  figure.panels.push_back(panel);
  figure.key = entries(names);
  return figure;
}

}  // namespace

TEST_CASE("keys of two to thirty entries above the frame: no entry over another, all in the picture") {
  for (const std::string name : {"AB", "smooth_A", "mmmmmmmmmmmm", "period doubling (pd_curve)"})
    for (const std::size_t count : {2U, 3U, 5U, 8U, 30U})
      for (const bool one_long : {false, true}) {
        std::vector<std::string> names(count, name);
        if (one_long) names[count / 2] = std::string(70, 'm');
        Figure figure = crowded(names);
        for (const auto& [width, height] : {std::pair(1200, 900), {720, 540}, {500, 900}}) {
          figure.width = width, figure.height = height;
          INFO(count << " times " << name << " in " << width << "x" << height);
          const FigureLayout layout = lay_out(figure);
          REQUIRE(layout.key);
          REQUIRE_FALSE(layout.key->inside);
          REQUIRE(layout.key->entries.size() == count);
          const std::vector<Box> places = boxes(*layout.key, names);
          for (std::size_t k = 0; k < count; ++k) {
            CHECK(places[k].left >= 0.0);
            CHECK(places[k].right <= width);
            CHECK(places[k].top <= height);
            CHECK(places[k].bottom >= layout.panels[0].frame.top);
            for (std::size_t other = 0; other < k; ++other) CHECK(shared_area(places[k], places[other]) == 0.0);
          }
          CHECK(layout.panels[0].frame.height() > 0.4 * height);
        }
      }
}

TEST_CASE("short keys stand in one row, each column as wide as its own text") {
  const KeyGrid grid(entries({"smooth_A", "born_A", "AB", "stable", "unstable"}), font, 1100.0, 300.0);
  const KeyPlace place = grid.place_above({100.0, 1160.0, 100.0, 830.0}, 1200.0);
  CHECK(place.font == font);
  for (const PicturePoint& at : place.entries) CHECK(at.y == place.entries[0].y);
  CHECK(place.entries[2].x - place.entries[1].x > place.entries[3].x - place.entries[2].x);
}

TEST_CASE("entries of the key are drawn where the layout has them") {
  const KeyGrid column(entries({"a", "b"}), font);
  const Obstacles empty{{0.0, 1200.0, 0.0, 900.0}, {}, {}, {}};
  const auto place = column.place_inside(empty);
  REQUIRE(place);
  CHECK(place->inside);
  CHECK(place->entries[0].x == place->entries[1].x);
  CHECK(place->entries[0].y > place->entries[1].y);
  for (const PicturePoint& at : place->entries) CHECK(place->box.contains(at));

  // At the left edge it keeps clear of the tics, which are about half as long as letters are high.
  Obstacles right_taken = empty;
  right_taken.curves.push_back({{1000.0, 0.0}, {1000.0, 900.0}});
  for (double x = 300.0; x < 1200.0; x += 20.0) right_taken.curves.push_back({{x, 0.0}, {x, 900.0}});
  const auto at_left = column.place_inside(right_taken);
  REQUIRE(at_left);
  CHECK(at_left->entries[0].x < 100.0);
  CHECK(at_left->entries[0].x > 0.7 * font);
}

// No placed label covers another one, a marker or the frame's edge; free places are found where there are some.
#include "plot/label_placement.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace tchat;

namespace {

const Box frame{0.0, 1000.0, 0.0, 700.0};

LabelRequest request(double x, double y) { return {{x, y}, 34.0, 22.0, 13.0}; }

Obstacles with_markers(const std::vector<LabelRequest>& requests) {
  Obstacles obstacles;
  obstacles.frame = frame;
  for (const LabelRequest& r : requests)
    obstacles.markers.push_back({r.at.x - 7.0, r.at.x + 7.0, r.at.y - 7.0, r.at.y + 7.0});
  return obstacles;
}

void check_free(const std::vector<std::optional<PlacedLabel>>& places) {
  for (std::size_t a = 0; a < places.size(); ++a) {
    if (!places[a]) continue;
    const Box& box = places[a]->box;
    CHECK(box.left >= frame.left);
    CHECK(box.right <= frame.right);
    CHECK(box.bottom >= frame.bottom);
    CHECK(box.top <= frame.top);
    for (std::size_t b = a + 1; b < places.size(); ++b)
      if (places[b]) CHECK(shared_area(box, places[b]->box) == 0.0);
  }
}

}  // namespace

TEST_CASE("areas and lengths in boxes") {
  const Box box{0.0, 2.0, 0.0, 1.0};
  CHECK(shared_area(box, {1.0, 3.0, 0.5, 4.0}) == Approx(0.5));
  CHECK(shared_area(box, {2.0, 3.0, 0.0, 1.0}) == 0.0);
  CHECK(length_inside(box, {-1.0, 0.5}, {3.0, 0.5}) == Approx(2.0));
  CHECK(length_inside(box, {0.5, -1.0}, {0.5, 0.25}) == Approx(0.25));
  CHECK(length_inside(box, {-1.0, 2.0}, {3.0, 2.0}) == 0.0);
  CHECK(length_inside(box, {0.0, 0.0}, {2.0, 1.0}) == Approx(std::sqrt(5.0)));
  CHECK(length_inside(box, {std::nan(""), 0.0}, {2.0, 1.0}) == 0.0);
}

TEST_CASE("a label alone stands close to its point, beside the curve") {
  Obstacles obstacles = with_markers({request(500.0, 350.0)});
  obstacles.curves = {{{0.0, 350.0}, {1000.0, 350.0}}, {{500.0, 350.0}, {1000.0, 700.0}}};
  const auto places = place_labels({request(500.0, 350.0)}, obstacles);
  REQUIRE(places[0]);
  CHECK_FALSE(places[0]->far);
  CHECK(obstacles.curve_length(places[0]->box) == 0.0);
  CHECK(std::hypot(places[0]->box.centre().x - 500.0, places[0]->box.centre().y - 350.0) < 60.0);
}

TEST_CASE("labels in a corner stay inside the frame") {
  const std::vector<LabelRequest> requests{request(2.0, 2.0), request(998.0, 2.0), request(2.0, 698.0),
                                           request(998.0, 698.0)};
  const auto places = place_labels(requests, with_markers(requests));
  for (const auto& place : places) CHECK(place.has_value());
  check_free(places);
}

TEST_CASE("points on a curve, close together: every label has a place and none covers another") {
  std::vector<LabelRequest> requests;
  std::vector<PicturePoint> curve;
  for (int k = 0; k <= 20; ++k) {
    const double x = 60.0 + 44.0 * k;
    requests.push_back(request(x, 100.0 + 0.0006 * x * x));
    curve.push_back(requests.back().at);
  }
  Obstacles obstacles = with_markers(requests);
  obstacles.curves.push_back(curve);
  const auto places = place_labels(requests, obstacles);
  for (const auto& place : places) {
    REQUIRE(place.has_value());
    CHECK(obstacles.curve_length(place->box) == 0.0);
    for (const Box& marker : obstacles.markers) CHECK(shared_area(place->box, marker) == 0.0);
  }
  check_free(places);
}

TEST_CASE("several labels at one point surround it") {
  const std::vector<LabelRequest> requests(4, request(500.0, 350.0));
  const auto places = place_labels(requests, with_markers(requests));
  for (const auto& place : places) CHECK(place.has_value());
  check_free(places);
}

TEST_CASE("crowds: what has no place is left out, the rest is free") {
  std::mt19937 random(11);
  std::normal_distribution<double> around(0.0, 40.0);
  std::vector<LabelRequest> requests;
  for (int k = 0; k < 120; ++k) requests.push_back(request(300.0 + around(random), 300.0 + around(random)));
  Obstacles obstacles = with_markers(requests);
  obstacles.forbidden.push_back({300.0, 600.0, 320.0, 500.0});
  const auto places = place_labels(requests, obstacles);
  check_free(places);
  std::size_t count = 0;
  for (const auto& place : places) {
    if (!place) continue;
    ++count;
    CHECK(shared_area(place->box, obstacles.forbidden[0]) == 0.0);
  }
  CHECK(count > 10);
}

TEST_CASE("one of many is left out rather than far away or on a marker") {
  std::vector<LabelRequest> requests;
  for (int k = 0; k < 40; ++k) requests.push_back(request(450.0 + 4.0 * k, 350.0));
  const Obstacles obstacles = with_markers(requests);
  for (LabelRequest& r : requests) r.only_beside = true;
  const auto places = place_labels(requests, obstacles);
  check_free(places);
  int placed = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!places[k]) continue;
    ++placed;
    CHECK_FALSE(places[k]->far);
    CHECK(std::abs(places[k]->box.centre().y - 350.0) < 50.0);
    for (const Box& marker : obstacles.markers) CHECK(shared_area(places[k]->box, marker) == 0.0);
  }
  CHECK(placed >= 6);
  CHECK(placed < 40);
}

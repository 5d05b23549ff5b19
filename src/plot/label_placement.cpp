#include "plot/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace tchat {

namespace {

constexpr int directions = 16;
constexpr int most_rounds = 6;
constexpr double outside_cost = 1000.0;
constexpr double label_cost = 200.0;  // the least, for a touch
constexpr double marker_cost = 20.0;
constexpr double curve_cost = 6.0;  // for a curve through the whole width

/// Multiples of the clearance, and what they cost.
struct Ring {
  double distance;
  double cost;
};
constexpr std::array<Ring, 4> rings = {{{1.0, 0.0}, {2.0, 1.0}, {4.5, 4.0}, {7.5, 8.0}}};
constexpr std::size_t first_far_ring = 2;

struct Candidate {
  PlacedLabel place;
  double cost = 0.0;  // without other labels
};

Box box_around(const PicturePoint& centre, double width, double height) {
  return {centre.x - 0.5 * width, centre.x + 0.5 * width, centre.y - 0.5 * height, centre.y + 0.5 * height};
}

/// To the right and upwards is usual.
double direction_cost(double angle) { return 0.25 * (1.0 - std::cos(angle - 0.25 * std::numbers::pi)); }

double static_cost(const LabelRequest& request, const Box& box, const Obstacles& obstacles) {
  double cost = 0.0;
  if (box.left < obstacles.frame.left || box.right > obstacles.frame.right || box.bottom < obstacles.frame.bottom ||
      box.top > obstacles.frame.top)
    cost += outside_cost;
  for (const Box& forbidden : obstacles.forbidden)
    if (shared_area(box, forbidden) > 0.0) cost += outside_cost;
  for (const Box& marker : obstacles.markers)
    if (shared_area(box, marker) > 0.0) cost += marker_cost;
  cost += curve_cost * obstacles.curve_length(box.grown(0.15 * request.height)) / request.width;
  return cost;
}

std::vector<Candidate> candidates(const LabelRequest& request, const Obstacles& obstacles) {
  std::vector<Candidate> result;
  for (std::size_t ring = 0; ring < (request.only_beside ? first_far_ring : rings.size()); ++ring) {
    for (int k = 0; k < directions; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / directions;
      const double distance = request.clearance * rings[ring].distance;
      const PicturePoint centre{request.at.x + (0.5 * request.width + distance) * std::cos(angle),
                                request.at.y + (0.5 * request.height + distance) * std::sin(angle)};
      Candidate candidate;
      candidate.place = {box_around(centre, request.width, request.height), ring >= first_far_ring};
      candidate.cost = rings[ring].cost + direction_cost(angle) + static_cost(request, candidate.place.box, obstacles);
      result.push_back(candidate);
    }
  }
  return result;
}

/// The labels' choices, improved in turn.
class Assignment {
 public:
  Assignment(const std::vector<LabelRequest>& requests, const Obstacles& obstacles) : chosen_(requests.size(), -1) {
    for (const LabelRequest& request : requests) {
      candidates_.push_back(candidates(request, obstacles));
      most_.push_back(request.only_beside ? marker_cost : outside_cost);
    }
  }

  void improve() {
    for (int round = 0; round < most_rounds; ++round) {
      bool moved = false;
      for (std::size_t k = 0; k < chosen_.size(); ++k) {
        const int best = cheapest(k);
        moved = moved || best != chosen_[k];
        chosen_[k] = best;
      }
      if (!moved) return;
    }
  }

  std::vector<std::optional<PlacedLabel>> result() {
    std::vector<std::optional<PlacedLabel>> places;
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const Candidate& candidate = at(k);
      const bool is_free = candidate.cost < most_[k] && overlap(k, candidate.place.box) == 0.0;
      if (is_free)
        places.emplace_back(candidate.place);
      else
        places.emplace_back(std::nullopt), chosen_[k] = -1;
    }
    return places;
  }

 private:
  const Candidate& at(std::size_t k) const { return candidates_[k][static_cast<std::size_t>(chosen_[k])]; }

  double overlap(std::size_t k, const Box& box) const {
    double cost = 0.0;
    for (std::size_t other = 0; other < chosen_.size(); ++other) {
      if (other == k || chosen_[other] < 0) continue;
      const double area = shared_area(box, at(other).place.box);
      if (area > 0.0) cost += label_cost * (1.0 + area / (box.width() * box.height()));
    }
    return cost;
  }

  int cheapest(std::size_t k) const {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < candidates_[k].size(); ++c) {
      const double cost = candidates_[k][c].cost + overlap(k, candidates_[k][c].place.box);
      if (cost < least) least = cost, best = static_cast<int>(c);
    }
    return best;
  }

  std::vector<std::vector<Candidate>> candidates_;
  std::vector<double> most_;  // that a place may cost
  std::vector<int> chosen_;   // -1: none yet
};

}  // namespace

double shared_area(const Box& a, const Box& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.top, b.top) - std::max(a.bottom, b.bottom);
  return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

double length_inside(const Box& box, const PicturePoint& a, const PicturePoint& b) {
  if (!is_finite(a) || !is_finite(b)) return 0.0;
  double from = 0.0, to = 1.0;  // the part of the line that is inside
  const auto clip = [&from, &to](double start, double step, double low, double high) {
    if (step == 0.0) return start >= low && start <= high;
    const double first = (low - start) / step, second = (high - start) / step;
    from = std::max(from, std::min(first, second));
    to = std::min(to, std::max(first, second));
    return from < to;
  };
  if (!clip(a.x, b.x - a.x, box.left, box.right) || !clip(a.y, b.y - a.y, box.bottom, box.top)) return 0.0;
  return (to - from) * std::hypot(b.x - a.x, b.y - a.y);
}

double Obstacles::curve_length(const Box& box) const {
  double length = 0.0;
  for (const auto& curve : curves)
    for (std::size_t k = 1; k < curve.size(); ++k) length += length_inside(box, curve[k - 1], curve[k]);
  return length;
}

std::vector<std::optional<PlacedLabel>> place_labels(const std::vector<LabelRequest>& requests,
                                                     const Obstacles& obstacles) {
  Assignment assignment(requests, obstacles);
  assignment.improve();
  return assignment.result();
}

}  // namespace tchat

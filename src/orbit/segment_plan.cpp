#include "orbit/segment_plan.hpp"

#include <algorithm>

namespace tchat {

namespace {

std::vector<int> lanes_in_use(const LaneSchedule& schedule) {
  std::vector<int> result;
  for (int l = 0; l < lanes; ++l)
    if (schedule.size(l) > 0) result.push_back(l);
  return result;
}

/// Pieces before those that they are part of, in an order that goes on with what was made last.
std::vector<PieceJoin> joins_of_halves(int pieces) {
  const auto halfway = SegmentPlan::halfway;
  std::vector<PieceJoin> result;
  std::vector<PieceJoin> open{{0, halfway(0, pieces), pieces}};
  while (!open.empty()) {  // a piece, its right half, its left half: the reverse of the order wanted
    const PieceJoin at = open.back();
    open.pop_back();
    if (at.last - at.first < 2) continue;
    result.push_back(at);
    open.push_back({at.first, halfway(at.first, at.middle), at.middle});
    open.push_back({at.middle, halfway(at.middle, at.last), at.last});
  }
  std::reverse(result.begin(), result.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i].number = static_cast<int>(i);
  return result;
}

/// A join is of the level after those of its two pieces.
std::vector<std::vector<PieceJoin>> levels_of(const std::vector<PieceJoin>& joins) {
  std::vector<std::vector<PieceJoin>> levels;
  for (const PieceJoin& at : joins) {
    std::size_t level = 0;
    for (int pieces = 1; pieces < at.last - at.first; pieces *= 2) ++level;
    levels.resize(std::max(levels.size(), level));
    levels[level - 1].push_back(at);
  }
  return levels;
}

}  // namespace

SegmentPlan::SegmentPlan(int intervals)
    : schedule(intervals),
      groups(schedule.groups()),
      joins(joins_of_halves(groups)),
      number_of_middle(static_cast<std::size_t>(groups)),
      levels(levels_of(joins)),
      top_lanes(lanes_in_use(schedule)),
      top_joins(joins_of_halves(static_cast<int>(top_lanes.size()))) {
  for (const PieceJoin& at : joins) number_of_middle[static_cast<std::size_t>(at.middle)] = at.number;
}

}  // namespace tchat

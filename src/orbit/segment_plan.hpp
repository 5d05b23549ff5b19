/// In which order the intervals of a segment are eliminated, and its pieces joined; by their number alone.
#pragma once

#include <cstddef>
#include <vector>

#include "linear/lane_kernel.hpp"

namespace tchat {

/// Which interval of a segment is where. Lanes have equally many intervals or one less: those have none in the last
/// group, the last lane always has one.
class LaneSchedule {
 public:
  explicit LaneSchedule(int intervals) : intervals_(intervals) {}
  int intervals() const { return intervals_; }
  /// Sets of one interval in each lane.
  int groups() const { return (intervals_ + lanes - 1) / lanes; }
  /// The first interval of a lane; that of lane `lanes` is the number of intervals.
  int start(int lane) const { return static_cast<int>(static_cast<long>(lane) * intervals_ / lanes); }
  int size(int lane) const { return start(lane + 1) - start(lane); }
  bool holds(int group, int lane) const { return group < size(lane); }
  /// The lane whose interval a lane computes with in a group: its own, or where it has none the last one's.
  int source(int group, int lane) const { return holds(group, lane) ? lane : lanes - 1; }
  int interval(int group, int lane) const { return start(source(group, lane)) + group; }
  /// The mesh node of a lane before its interval `group`, or where it has none at its end.
  int node(int group, int lane) const { return group < size(lane) ? start(lane) + group : start(lane + 1); }

 private:
  int intervals_;
};

/// The elimination of what is between pieces first..middle-1 and middle..last-1.
struct PieceJoin {
  int first, middle, last;
  int number = 0;  ///< among all joins in the order in which they are done
};

struct SegmentPlan {
  explicit SegmentPlan(int intervals);

  LaneSchedule schedule;
  int groups;
  std::vector<PieceJoin> joins;                ///< of groups, each after those that make its two pieces
  std::vector<int> number_of_middle;           ///< of those joins
  std::vector<std::vector<PieceJoin>> levels;  ///< the same, those of one level independent of one another
  std::vector<int> top_lanes;                  ///< that have intervals
  std::vector<PieceJoin> top_joins;            ///< of top_lanes

  static int halfway(int first, int last) { return first + (last - first) / 2; }
  const PieceJoin& join_of(int first, int last) const {
    return joins[static_cast<std::size_t>(number_of_middle[static_cast<std::size_t>(halfway(first, last))])];
  }
  /// Does a lane have nothing on the right side of a join?
  bool passes(const PieceJoin& at, int lane) const { return at.middle >= schedule.size(lane); }
  /// The mesh node where a piece of a lane begins; of one beyond the last, where the segment ends.
  int top_node(int piece) const {
    return piece < static_cast<int>(top_lanes.size()) ? schedule.start(top_lanes[static_cast<std::size_t>(piece)])
                                                      : schedule.intervals();
  }
};

}  // namespace tchat

/// Location of branch points within a step, and whether steps are short enough to see every change of sign.
#pragma once

#include <functional>
#include <limits>
#include <span>

#include "continuation/branch.hpp"

namespace tchat {

// Location of a zero where Newton's matrix is singular: a branch point within a continuation step.
//
// A trial step right on top of a branch point fails, or comes out anywhere within the square root of rounding, or on
// the other branch. So no trial step goes there. Trial points close in on the zero from both sides at a distance that
// shrinks with the bracket; between them the branch is smooth, and the zero is placed by interpolation:
//
//     test function      polynomial through the nearest four points, along the arclength of the step,
//     orbit, tangent     cubic Hermite between the two ends of the bracket,
//
// until the place no longer moves and the interpolated orbit satisfies the equations to rounding. The latter may be
// out of reach: trial points are as accurate as Newton's tolerances, and the closer the matrix comes to a singular
// one, the less accurate are its solutions. When the place begins to move again, the bracket goes back to where it
// moved least. The same cubic is the start of Newton's method at trial points, which keeps them on the branch.

class PathFollower;

class BranchPointBracket {
 public:
  /// Evaluates a converged point, whose linearisation the follower holds.
  using Evaluate = std::function<PointData(PathPoint&)>;
  /// A point of the branch at an arclength from the start of the step.
  struct Side {
    double at = 0.0;  ///< without the sign of the step
    double value = 0.0;
    Orbit orbit;
    OrbitVector slope;  ///< d orbit / d at
    PointData data;
  };

  /// From `start` (evaluated as `start_data`) a step has led to `end`, where the test function has another sign than
  /// `sign`, which it had before the zero. The follower and the start must outlive this object.
  BranchPointBracket(PathFollower& follower, const PathPoint& start, const PointData& start_data, const Candidate& end,
                     std::size_t test, int sign);

  /// `trial` is overwritten. False when the function has no zero there that could be located.
  bool narrow(const Evaluate& evaluate, PathPoint& trial, double tolerance);

  std::size_t test() const { return test_; }
  double length() const { return direction_ * zero_; }           ///< of the step to the zero
  double length_before() const { return direction_ * low_.at; }  ///< of the step to before()
  const Side& before() const { return low_; }
  const Side& after() const { return high_; }
  /// The interpolated point and its unit tangent.
  void put_zero(PathPoint& point) const { put(zero_, point); }

 private:
  Side make_side(double at, const PathPoint& point, const PointData& data) const;
  bool find_sign(const Evaluate& evaluate, PathPoint& trial);
  bool try_at(double at, const Evaluate& evaluate, PathPoint& trial);
  double interpolated_zero() const;
  void put(double at, PathPoint& point) const;

  PathFollower& follower_;
  const PathPoint& start_;
  std::size_t test_;
  int sign_;
  double direction_;
  Side low_;
  Side high_;
  struct Node {
    double at;
    double value;
  };
  std::vector<Node> nodes_;  // every evaluated point
  double zero_ = 0.0;
  /// A state of the bracket to come back to.
  struct Located {
    double error = std::numeric_limits<double>::infinity();  // of the place, as far as two rounds tell
    double moved = error;                                    // by the last round
    double zero = 0.0;
    Side low;
    Side high;
  };
};

// Do the values of a test function along a branch lie close enough together to see every change of sign?
//
// The polynomial through earlier values foretells the next one, and tells with it what lies in between: two zeros
// between two values of one sign; for a function that oscillates, a dip near to zero there, or a value far from what
// was expected, is reason enough to look closer.

struct TrendValue {
  double at;  ///< arclength
  double value;
};

/// `past` in the order of the branch, `next` beyond its last one. With fewer than two values there is no trend, and any
/// next one follows it.
bool follows_trend(std::span<const TrendValue> past, const TrendValue& next);

/// Have the cubic through the last three values and the next one, and the parabola through the last two, two zeros
/// between the last one and the next? With fewer than three values there is no cubic.
bool has_two_zeros(std::span<const TrendValue> past, const TrendValue& next);

}  // namespace tchat

/// Does a branch come back to its first point? A closed branch (an isola, a closed curve of folds) is gone round once.
///
/// The first point F has been passed on the step from A to B when F lies between the planes across A's tangent through
/// A and B, and the point that a step from A reaches in the plane through F, with A moved to the mesh of F, is F: the
/// same unknowns to Newton's tolerances, the same direction. On one mesh F and the point reached are solutions of the
/// same discrete equations, so that no difference of meshes blurs the comparison, and a branch that passes near its
/// first point, or crosses itself there in another direction, is not taken for closed.
///
/// Where no event fixes the phase of an orbit, it moves along the branch: then parameters, durations, and the means and
/// root mean squares of the states are compared.
#pragma once

#include <optional>

#include "continuation/path_point.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

class DefiningSystem;
class PathFollower;

class ClosedBranch {
 public:
  /// `phase_is_fixed`: equal orbits have equal states at equal tau.
  ClosedBranch(PathFollower& follower, const DefiningSystem& system, bool phase_is_fixed)
      : follower_(follower), system_(system), phase_is_fixed_(phase_is_fixed) {}

  /// The first point of a branch; `direction` is the sign of its steps.
  void begin(const PathPoint& first, double direction);
  /// A step that has been accepted.
  void add_step(double ds) { travelled_ += ds < 0.0 ? -ds : ds; }

  /// The first point on the way: a step of this length from `from`, which is the start of the step moved to the mesh of
  /// the first point.
  struct Return {
    PathPoint from;
    double length;
  };
  /// Is it passed on the step of length ds from `here` to `next`? Trial steps may be made: where there are any and the
  /// answer is no, the follower holds the linearisation at `next` again.
  std::optional<Return> on_step(const PathPoint& here, const PathPoint& next, double ds);

 private:
  std::optional<double> place(const PathPoint& here, double ds);
  std::optional<double> place_of_measures(const PathPoint& here, const PathPoint& next, double ds) const;
  bool reach(Return& way, const PathPoint& next, double ds);
  bool is_first(const PathPoint& point) const;
  Eigen::VectorXd measures(const Orbit& x) const;

  PathFollower& follower_;
  const DefiningSystem& system_;
  bool phase_is_fixed_;
  PathPoint first_;
  MeshTransfer transfer_;          // from the mesh of the first point
  Orbit moved_;                    // that of the first point on the mesh of the last one looked at
  Eigen::VectorXd measure_sizes_;  // empty before they are known
  Eigen::VectorXd first_measures_;
  Eigen::VectorXd first_direction_;  // of the measures
  double travelled_ = 0.0;
};

}  // namespace tchat

/// Where a branch ends: at its bounds, at limits of the orbits, or at its own first point.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "continuation/branch.hpp"
#include "continuation/path_follower.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/orbit.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Where a branch of orbits ends of itself: the mesh no longer resolves them, or a duration passes infinity or zero.

class DefiningSystem;

/// Which figure of accuracy exceeds `bound` (ERRMAX; 0: none does), with its value, or "". The figures are
///   - the estimated error of the orbit (orbit/collocation_rule.hpp),
///   - the structural multiplier, or the trivial one's distance from 1, where multipliers are computed and not lost at
///     an equilibrium (FloquetMultipliers::is_flow_lost),
///   - the factor exp(z) by which perturbations grow, or the flow grows or decays, on one mesh interval. Here z is
///     h T |Re lambda| with an eigenvalue lambda of f_x, where one of them grows by more than exp(1) on the interval,
///     or h T |d ln |f| / dt|, the lesser of the values at both ends. Collocation at c Gauss points has the relative
///     error (c!)^2 / ((2c)! (2c+1)!) z^(2c+1) of this factor. Where it exceeds 1, multipliers and durations are those
///     of the mesh. It counts for orbits with a multiplier outside of the unit circle: the others contract local
///     errors, as relaxation oscillations do. Of those only the decay of |f| on the last interval of a segment counts,
///     on which the time of the event depends. Where multipliers are lost it counts on intervals on which the orbit
///     moves: resting, it is known better than what grows beside it.
std::string unresolved_by_mesh(const DefiningSystem& system, const Orbit& x, const PointData& data, double bound);

/// Why a point is none of a curve that keeps a real multiplier at 1 or -1, "" where it may be one: the condition's
/// function vanishes also where segments last no time and end tangentially, without such a multiplier.
std::string lost_multiplier(const OrbitCondition* condition, const PointData& data);

/// "" or that a segment ends at rest to within rounding, |f| T below 1e-12 of the states: its duration is not
/// determined.
std::string undetermined_duration(const DefiningSystem& system, const Orbit& x);

/// The period or the duration of a segment that has passed infinity on a step of signed length ds between two points,
/// or "". No orbits lie beyond.
std::string passed_infinity(const PathPoint& from, const PathPoint& to, double ds);

/// "" or that the period has passed zero, beyond the accuracy of a located point.
std::string passed_zero(const Orbit& from, const Orbit& to);

/// "" or that the duration of a segment has. That is grazing, which has a label of its own where the branch ends unless
/// GRSTOP = 0; a branch that begins at one may lead to the wrong side.
std::string passed_zero_segment(const Orbit& from, const Orbit& to);

// The bounds of a branch: RL0, RL1 of the principal parameter, A0, A1 of the solution measure, BOUNDS of any other
// quantity. A branch ends at the first point beyond them, or on them (--clip).

/// The range of one quantity: an entry of PAR (a parameter, duration or monitor) or the solution measure.
struct BranchBounds {
  static constexpr int solution_measure = 0;
  int parameter = solution_measure;         ///< index in PAR, from 1; or the solution measure
  std::string quantity;                     ///< its name
  std::string least_keyword, most_keyword;  ///< constants that set the range: RL0 and RL1, A0 and A1, BOUNDS twice
  double least = -1e300, most = 1e300;
  int measure = 0;               ///< IPLT, of the solution measure
  Eigen::VectorXd weights = {};  ///< THU, n entries, likewise
  Eigen::VectorXd units = {};    ///< of the states, likewise; none: all are 1

  double value(const Orbit& orbit, const CollocationRule& rule) const;
  /// Is there a bound that excludes anything? 1e300 does not.
  bool is_finite() const;
  /// "RL0, RL1", or "BOUNDS"
  std::string keywords() const;
};

/// A test function for each finite bound: the value minus the bound. Their zeros are end points.
std::vector<std::unique_ptr<TestFunction>> bound_tests(const std::vector<BranchBounds>& bounds);

// Does a branch come back to its first point? A closed branch (an isola, a closed curve of folds) is gone round once.
//
// The first point F has been passed on the step from A to B when F lies between the planes across A's tangent through
// A and B, and the point that a step from A reaches in the plane through F, with A moved to the mesh of F, is F: the
// same unknowns to Newton's tolerances, the same direction. On one mesh F and the point reached are solutions of the
// same discrete equations, so that no difference of meshes blurs the comparison, and a branch that passes near its
// first point, or crosses itself there in another direction, is not taken for closed.
//
// Where no event fixes the phase of an orbit, it moves along the branch: then parameters, durations, and the means and
// root mean squares of the states are compared.

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
  Eigen::VectorXd sizes_of_measures(const Orbit& x, const Eigen::VectorXd& measured) const;

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

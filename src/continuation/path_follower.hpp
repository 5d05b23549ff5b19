/// Pseudo-arclength continuation: points of a branch, the points before them, and the steps between.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "continuation/newton_chord.hpp"
#include "continuation/predictor.hpp"
#include "continuation/solution_measure.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// Where a branch has come from: the points before a path point, for predictors that use them.
//
// A trail is a value that belongs to its point. Trial steps that fail leave no trace in it.

struct PathPoint;
class MeshTransfer;

class PathTrail {
 public:
  static constexpr int most = 3;

  PathTrail() = default;
  /// With space for the points that it will add itself; empty.
  PathTrail(const OrbitShape& shape, int global_count);
  PathTrail(const PathTrail& other);
  PathTrail& operator=(const PathTrail& other);
  PathTrail(PathTrail&&) = default;
  PathTrail& operator=(PathTrail&&) = default;
  ~PathTrail() = default;

  bool empty() const { return count_ == 0; }
  void clear();

  /// The trail of a point that was reached from this one: its trail and itself.
  void follow(const PathPoint& from, const std::vector<int>& free_parameters);
  /// The same points, and this one, which lies beside or ahead of the point that the trail belongs to.
  void add(const PathPoint& point, const std::vector<int>& free_parameters);

  /// Moves all points.
  void change_mesh(const std::vector<double>& mesh, const MeshTransfer& transfer);

  /// A point as a vector, and its unit tangent.
  struct Mark {
    OrbitVector place;
    OrbitVector tangent;
  };
  int count() const { return count_; }
  const Mark& mark(int k) const { return *marks_[index(k)]; }  ///< the newest is number 0
  const std::vector<double>& mesh() const { return mesh_; }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  std::shared_ptr<Mark> unused_mark();

  std::array<std::shared_ptr<const Mark>, most> marks_;  // shared with the trails of other points
  // Space for the points that this trail adds or moves to another mesh, made when it is needed: the first to be in no
  // trail is the next to be used. Two take turns where two points follow each other by turns; a point that is kept on
  // its old mesh has the moved one's marks twice.
  std::array<std::shared_ptr<Mark>, static_cast<std::size_t>(2 * most + 2)> own_;
  int count_ = 0;
  std::vector<double> mesh_;
};

// A point of a branch, with what the next step from it needs.

struct PathPoint {
  Orbit orbit;
  OrbitVector tangent;     ///< unit length
  OrbitVector dual;        ///< <tangent, .> on the orbit's mesh
  ConditionMemory memory;  ///< of a two-parameter curve's condition
  PathTrail trail = {};    ///< points before it
  /// Newton's second correction over the square of the first, from the tangent: the last that is known, 0 for none.
  double newton_constant = 0.0;
};

// Pseudo-arclength continuation of a defining system: starting, predicting, correcting (5.50-5.55).
//
// A path point carries its unit tangent in the weighted norm, oriented along the branch. A step of length ds predicts
// x + ds v, or as its predictor says (predictor.hpp), and corrects with <v, x_new - x> = ds; the tangent at the
// new point comes from the factors of its linearisation, which stay available for multipliers and test functions. A
// prediction of higher order is brought nearer by chord iterations with the factors at hand, so that one more matrix
// is enough; where Newton's method fails from it or takes much of it back, that along the tangent is taken. Everything
// else that a step begins from is in the point that it goes from: trials before it, failed ones too, leave no trace
// beyond rounding.

/// What is known of a number of iterations: it is one of these.
struct IterationRange {
  int least = 1;
  int most = 1;
};

/// What is watched along a branch, and what is held on it besides the defining system.
struct BranchMonitors {
  MonitorSet watched = {};
  std::vector<HeldMonitor> held = {};
};

class PathFollower {
 public:
  /// `principal` is the PAR index of the continuation parameter: a free problem parameter, a duration or a monitor that
  /// has a gradient. `condition` is the further scalar condition of a two-parameter curve, null for none.
  PathFollower(const DefiningSystem& system, const OrbitShape& shape, WeightedNorm norm, const NewtonSettings& settings,
               int principal, std::unique_ptr<OrbitCondition> condition = nullptr, BranchMonitors monitors = {});

  PathPoint make_point(Orbit orbit) const;

  /// Corrects point.orbit with the principal parameter fixed; then the tangent along which it grows.
  NewtonResult start_at_fixed_parameter(PathPoint& point);
  /// Corrects point.orbit orthogonally to the given direction and takes over its orientation.
  NewtonResult start_along(PathPoint& point, const OrbitVector& direction);
  /// Corrects point.orbit by minimum-norm steps with the principal parameter free, where fixing it gives a singular
  /// matrix (folds, codimension-two points); then the tangent along which the principal parameter grows.
  NewtonResult start_by_minimum_norm(PathPoint& point);

  /// One step of signed length ds; `to` must come from make_point or be a former path point.
  NewtonResult step(const PathPoint& from, double ds, PathPoint& to);

  /// The same, always from the tangent.
  NewtonResult step_along_tangent(const PathPoint& from, double ds, PathPoint& to);

  /// Gives a point another tangent, on the same mesh, of any length; factors that are at hand are not used again.
  void set_tangent(PathPoint& point, const OrbitVector& tangent);

  /// How many iterations Newton's method takes for this step when it starts on the tangent, whatever predictor the step
  /// had. condensed() must be the linearisation at `to`; a chord iteration from the tangent with its factors tells it
  /// `exactly` and to.newton_constant, else it is estimated by that of `from`.
  IterationRange iterations_along_tangent(const PathPoint& from, double ds, PathPoint& to, bool exactly);

  /// The same point beside a branch point. Newton starts at what to.orbit holds, and the matrix is always made anew for
  /// the tangent, of which the other branch would take a share that is the distance to an older matrix, over that to
  /// the branch point.
  NewtonResult step_beside_branch_point(const PathPoint& from, double ds, PathPoint& to);

  /// Are the equations satisfied to rounding?
  bool solves(const Orbit& x);
  /// The largest residual over 1 + max |u|.
  double relative_residual(const Orbit& x);

  /// Moves the point to a new mesh of the same size: states and tangent are interpolated, the tangent renormalised.
  /// `shape`: of orbits on that mesh, the point's own unless its segments have other numbers of intervals there.
  void change_mesh(PathPoint& point, const OrbitShape& shape, const std::vector<double>& mesh);
  void change_mesh(PathPoint& point, const std::vector<double>& mesh) { change_mesh(point, point.orbit.shape, mesh); }
  void reverse(PathPoint& point) const;
  /// Makes the tangent one of unit length and the dual its own.
  void renormalise(PathPoint& point) const { normalise(point.orbit, point.tangent, point.dual); }

  /// Makes condensed() the linearisation at a converged point. False when it is singular.
  bool linearize_at(const PathPoint& point);

  /// The linearisation at the last point that start_..., step or linearize_at was given, current to about 1e-10.
  CondensedSystem& condensed() { return problem_.condensed(); }
  const CondensedSystem& condensed() const { return problem_.condensed(); }
  OrbitCondition* condition() { return problem_.condition(); }
  const NewtonChord& newton() const { return newton_; }
  const NewtonSettings& newton_settings() const { return settings_; }
  int principal() const { return principal_; }  ///< PAR index of the continuation parameter
  /// By how much the principal parameter grows along the tangent.
  double principal_direction(const PathPoint& point) const;
  /// The largest change along the tangent, each relative to its size.
  double relative_length(const PathPoint& point) const;
  /// Against which that is small: the size of the parameter times the largest relative change along the tangent.
  double principal_rate_size(const PathPoint& point) const;
  /// Which share of its value, or of its size where it is zero, it changes by, compared with what changes most along
  /// the tangent.
  double principal_share(const PathPoint& point) const;
  const MonitorSet& monitors() const { return monitors_; }
  const std::vector<HeldMonitor>& held() const { return problem_.held(); }
  /// Cosine of the angle between the point's tangent and a direction, in the weighted norm.
  double alignment(const PathPoint& point, const OrbitVector& direction) const;
  /// The same between the tangents of two points of one shape, of which only the ends of segments, durations and free
  /// parameters count: what the border of the second one's factors has of its tangent after a step from the first.
  /// 1 where the distance to a singular problem does not depend on the border (CondensedSystem::closing_rows_gave_way).
  double cosine_at_ends(const PathPoint& from, const PathPoint& to) const;

  /// To a singular problem, at the point whose linearisation is held (BorderedProblem::signed_distance).
  double signed_distance(const PathPoint& held) { return problem_.signed_distance(held.dual); }

  /// The length of the difference of two orbits on one mesh, in the weighted norm.
  double distance(const Orbit& a, const Orbit& b) const;

  /// Condition of the system bordered by the tangent, at the last point.
  CondensedSystem::Singularity singularity(const PathPoint& point);

 private:
  NewtonResult step_from_plane(const PathPoint& from, double ahead, PathPoint& to, double oldest);
  double ahead(const PathPoint& from, double ds, const Orbit& x) const;
  NewtonResult correct_and_orient(PathPoint& point, const OrbitVector& row, double change_along_row, double oldest);
  void put_on_tangent(const PathPoint& from, double ds, Orbit& x) const;
  void begin_step(const PathPoint& from);
  double polish(const PathPoint& from, double expected, Orbit& x);
  OrbitChange difference(const Orbit& to, const Orbit& x, double step, const OrbitVector& v);
  int iterations_of(const OrbitChange& first, const OrbitChange& second, double constant) const;
  OrbitChange chord(const PathPoint& from, const Orbit& x);
  bool linearize(const Orbit& x, const OrbitVector& row);
  bool find_tangent(const Orbit& x, const OrbitVector& row, OrbitVector& tangent, OrbitVector& dual);
  double measure(const Orbit& x, const OrbitVector& v, OrbitVector& dual) const;
  void normalise(const Orbit& x, OrbitVector& tangent, OrbitVector& dual) const;
  void orient(PathPoint& point) const;
  OrbitVector principal_row(const Orbit& x) const;
  Eigen::Index principal_global() const;  // of a problem parameter: its place among the free ones

  const DefiningSystem& system_;
  WeightedNorm norm_;
  int principal_;
  MonitorSet monitors_;
  BorderedProblem problem_;
  NewtonChord newton_;
  std::unique_ptr<Predictor> predictor_;
  NewtonSettings settings_;
  ConditionMemory unused_;  // the condition's before anything was evaluated
  OrbitVector dx_;          // of chord iterations
  MeshTransfer transfer_;   // of change_mesh()
  Eigen::MatrixXd moved_;
  Orbit on_tangent_;
  bool factors_known_ = false;  // those of condensed()
};

}  // namespace tchat

/// Continuation of the impacting orbit in alpha with fixed step, as often as a measurement needs: forwards a number of
/// steps, back again, and so on.
#pragma once

#include "continuation/path_follower.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat::benchmark {

inline constexpr NewtonSettings newton_settings{8, 3, 1e-7, 1e-7};
inline constexpr int collocation_points = 4;

/// The arclength of one step grows with the root of the number of segments, so that all orbits move equally far.
double step_length(int segments);

/// Of dimension 4 unless told.
OrbitShape walk_shape(int segments, int intervals, int dimension = 4);

class BranchWalk {
 public:
  /// Turns round after `steps_one_way` steps; of dimension 4 the oscillator, else the chain. Throws std::runtime_error
  /// when Newton does not converge at the start.
  explicit BranchWalk(const OrbitShape& shape, int steps_one_way = 40);
  BranchWalk(const BranchWalk&) = delete;
  BranchWalk& operator=(const BranchWalk&) = delete;

  /// One step from point() to the next point(); throws std::runtime_error when it fails.
  void step();
  FloquetMultipliers multipliers() { return floquet_.compute(follower_.condensed(), point_.orbit); }

  const PathPoint& point() const { return point_; }
  PathFollower& follower() { return follower_; }
  const DefiningSystem& system() const { return system_; }
  int steps() const { return steps_; }
  int steps_one_way() const { return steps_one_way_; }
  /// Newton iterations and Newton matrices (the one for the tangent included) per step so far.
  double iterations_per_step() const { return static_cast<double>(iterations_) / steps_; }
  double matrices_per_step() const { return static_cast<double>(matrices_) / steps_; }

 private:
  PeriodicOrbitSystem system_;
  PathFollower follower_;
  FloquetSolver floquet_;
  PathPoint point_;
  PathPoint next_;
  double ds_;
  int steps_one_way_;
  int steps_ = 0;
  int iterations_ = 0;
  int matrices_ = 0;
};

/// Processor time of a step and of its multipliers, in seconds.
struct StepCost {
  double step = 0.0;
  double multipliers = 0.0;
};

/// Mean over one way there and back: steps along a branch need two Newton matrices or three, and all of them count.
StepCost cost_there_and_back(BranchWalk& walk);

}  // namespace tchat::benchmark

/// The solver assembled for one signature, as a run does it, with a sink that keeps what it is given.
#pragma once

#include <memory>
#include <vector>

#include "continuation/continuation_run.hpp"
#include "orbit/mesh_adaptation.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "stability/floquet_multipliers.hpp"

namespace tchat::test {

inline NewtonSettings tight_newton() { return {12, 4, 1e-11, 1e-11}; }

/// Continues periodic orbits of `signature` in PAR(principal), durations free.
class PeriodicOrbits {
 public:
  PeriodicOrbits(const HybridSystem& hybrid, const Signature& signature, int principal, const OrbitShape& shape,
                 const NewtonSettings& newton = tight_newton())
      : system(hybrid, signature, {principal}),
        follower(system, shape, WeightedNorm::unit(shape), newton, principal),
        floquet_(shape) {}

  /// Newton with the parameter fixed.
  NewtonResult start(PathPoint& point) { return follower.start_at_fixed_parameter(point); }
  PathPoint corrected(const Orbit& orbit) {
    PathPoint point = follower.make_point(orbit);
    result = start(point);
    return point;
  }
  /// At the point that was corrected last.
  FloquetMultipliers multipliers(const PathPoint& point) {
    follower.linearize_at(point);
    return floquet_.compute(follower.condensed(), point.orbit);
  }

  PeriodicOrbitSystem system;
  PathFollower follower;
  NewtonResult result;  ///< of the last call of corrected()

 private:
  FloquetSolver floquet_;
};

struct KeptPoint {
  int number;
  SpecialPoint special;
  Orbit orbit;
  FloquetMultipliers multipliers;
  std::vector<Violation> violations;
  double estimated_error;
  int newton_iterations;
  double step;
  std::vector<NamedTestValue> tests;
};

class KeepingSink final : public BranchSink {
 public:
  void point(const BranchPoint& p) override {
    points.push_back({p.number, p.special, p.path.orbit, p.multipliers, p.violations, p.estimated_error,
                      p.newton_iterations, p.step, p.tests});
  }
  void next_step(int, double) override {}
  void note(int, const std::string& text) override { notes.push_back(text); }
  void passed(const LostPoint& point) override { passed_points.push_back(point); }

  std::vector<KeptPoint> points;
  std::vector<std::string> notes;
  std::vector<LostPoint> passed_points;
};

inline ContinuationSettings branch_settings(const OrbitShape& shape, int principal, double ds, double ds_max,
                                            int points) {
  ContinuationSettings settings;
  settings.step.initial = ds;
  settings.step.maximum = ds_max;
  settings.step.max_newton = 12;
  settings.max_points = points;
  settings.principal = principal;
  settings.state_weights = Eigen::VectorXd::Ones(shape.dimension);
  settings.monitored.resize(static_cast<std::size_t>(shape.segments));
  return settings;
}

}  // namespace tchat::test

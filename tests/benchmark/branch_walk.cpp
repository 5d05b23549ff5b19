#include "benchmark/branch_walk.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "benchmark/impacting_orbit.hpp"
#include "benchmark/timing.hpp"

namespace tchat::benchmark {

namespace {

constexpr int alpha = 1;
/// PathFollower renews factors that are older than this before it takes the tangent from them.
constexpr double current_enough = 1e-10;

void require_convergence(const NewtonResult& result) {
  if (!result.converged())
    throw std::runtime_error("continuation of the impacting orbit failed: " + describe(result.status));
}

}  // namespace

double step_length(int segments) { return 0.02 * std::sqrt(static_cast<double>(segments)); }

OrbitShape walk_shape(int segments, int intervals, int dimension) {
  return {dimension, segments, intervals, collocation_points};
}

BranchWalk::BranchWalk(const OrbitShape& shape, int steps_one_way)
    : system_(shape.dimension == 4 ? oscillator() : chain(shape.dimension), impacting_signature(shape.segments),
              {alpha}),
      follower_(system_, shape, WeightedNorm::unit(shape), newton_settings, alpha),
      floquet_(shape),
      point_(follower_.make_point(impacting_orbit(shape))),
      next_(point_),
      ds_(step_length(shape.segments)),
      steps_one_way_(steps_one_way) {
  require_convergence(follower_.start_at_fixed_parameter(point_));
  next_ = point_;
}

void BranchWalk::step() {
  if (steps_ > 0 && steps_ % steps_one_way_ == 0) ds_ = -ds_;
  const NewtonResult result = follower_.step(point_, ds_, next_);
  require_convergence(result);
  std::swap(point_, next_);
  ++steps_;
  iterations_ += result.iterations;
  matrices_ += std::min(result.iterations, newton_settings.full_iterations);
  if (result.change_since_factorization > current_enough) ++matrices_;
}

StepCost cost_there_and_back(BranchWalk& walk) {
  const int steps = 2 * walk.steps_one_way();
  StepCost cost;
  for (int k = 0; k < steps; ++k) {
    cost.step += processor_seconds([&] { walk.step(); }) / steps;
    cost.multipliers += processor_seconds([&] { keep(walk.multipliers()); }) / steps;
  }
  return cost;
}

}  // namespace tchat::benchmark

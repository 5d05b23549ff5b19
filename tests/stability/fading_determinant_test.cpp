// Branches along which the determinant of the boundary value problem changes by hundreds of decades, like
// exp(-T tr f_x / 2): every branch point is found, and nothing else is taken for one.
#include <catch2/catch.hpp>
#include <cmath>

#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// Folds and branch points on the branch in PAR(parameter) from one bound to the other.
RecordedBranch follow(PeriodicOrbits& orbits, const Orbit& start, int parameter, double low, double high,
                      double direction, double largest_step) {
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, parameter, 0.05 * direction, largest_step, 4000);
  settings.parameter_min = low;
  settings.parameter_max = high;
  settings.multipliers = false;
  settings.adapt_mesh_every = 3;
  Tests tests;
  tests.push_back(std::make_unique<FoldTest>(parameter, orbits.system.free_parameters(), ParameterLayout(), 1, false));
  tests.push_back(std::make_unique<BranchPointTest>(false));
  RecordedBranch branch = record(orbits.follower, orbits.system, point, settings, std::move(tests));
  CAPTURE(branch.notes);
  CHECK(branch.summary.reason == EndReason::beyond_bound);
  return branch;
}

}  // namespace

TEST_CASE("nonimpacting orbits of the linear oscillator from omega = 0.1 to 8 and back: no branch point, no fold",
          "[slow]") {
  const double low = 0.1, high = 8.0;
  const double direction = GENERATE(1.0, -1.0);
  const int intervals = GENERATE(50, 100, 400);
  const double largest_step = GENERATE(0.1, 1.0);
  CAPTURE(direction, intervals, largest_step);
  const OscillatorOrbit first = nonimpacting_orbit(direction > 0.0 ? low : high, 1.0);
  const Orbit start = sampled_orbit({first.piece(0.0, first.constants.period())}, 4, intervals, 4, first.par());
  PeriodicOrbits orbits(linosc(), {{1, 2, 2}}, 2, start.shape);
  const RecordedBranch branch = follow(orbits, start, 2, low, high, direction, largest_step);
  CAPTURE(branch.notes);
  CHECK(branch.special().empty());
}

namespace {

/// The unit circle, attracting; w' = (mu - 3) w - w^3 beside it, and four states that follow the circle, damped more
/// and more strongly as mu grows. The orbit w = 0 has one branch point, at mu = 3.
struct DampedMore {
  static constexpr int dimension = 7, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T inward = 1.0 - x[0] * x[0] - x[1] * x[1];
    f[0] = inward * x[0] - x[1];
    f[1] = inward * x[1] + x[0];
    f[2] = (p[0] - 3.0) * x[2] - x[2] * x[2] * x[2];
    for (int i = 0; i < 4; ++i) f[3 + i] = p[0] * (i + 1.0) * (x[0] - x[3 + i]);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }
};

/// z' = k (cos t - z) is followed by z = k (k cos t + sin t) / (k^2 + 1). The event falls through zero at t = pi.
Eigen::VectorXd damped_state(double t, double mu) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(7);
  x(0) = std::cos(t), x(1) = std::sin(t);
  for (int i = 0; i < 4; ++i) {
    const double k = mu * (i + 1.0);
    x(3 + i) = k * (k * std::cos(t) + std::sin(t)) / (k * k + 1.0);
  }
  return x;
}

}  // namespace

TEST_CASE("seven states, four of them damped more and more: the branch point at 3 and none else") {
  const double low = 0.5, high = 5.0;  // tr f_x from -10 to -50
  const double direction = GENERATE(1.0, -1.0);
  const int intervals = GENERATE(20, 50, 200);
  CAPTURE(direction, intervals);
  const double from = direction > 0.0 ? low : high;
  const Piece piece{2 * pi, [&](double t) { return damped_state(t + pi, from); }};
  const Orbit start = sampled_orbit({piece}, 7, intervals, 4, parameters({from}));
  PeriodicOrbits orbits(system_of<DampedMore>(), {{1, 1, 1}}, 1, start.shape);
  const RecordedBranch branch = follow(orbits, start, 1, low, high, direction, 0.4);
  CAPTURE(branch.notes);
  REQUIRE(branch.special().size() == 1);
  CHECK(branch.special().front()->special.type == PointType::branch_point);
  // w = 0 is invariant under collocation too, and the multiplier there is exp(2 pi (mu - 3)) on any mesh but for the
  // error of the duration.
  CHECK(std::abs(branch.special().front()->orbit.par(0) - 3.0) < 1e-6);
}

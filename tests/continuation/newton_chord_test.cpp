// Newton-chord iteration: speed, the meaning of its settings, and every way it can fail.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// Van der Pol's cycle with the states scaled by `factor`, corrected with mu fixed.
struct Attempt {
  NewtonResult result;
  std::vector<NewtonIteration> history;
  Orbit orbit;
};

const PeriodicOrbit& cycle() {
  static const PeriodicOrbit found = van_der_pol_cycle(1.0);
  return found;
}

Attempt attempt(double factor, const NewtonSettings& settings) {
  Orbit start = sampled_orbit(van_der_pol_pieces(cycle(), 1.0), 2, 40, 4, parameters({1.0}));
  start.states *= factor;
  PeriodicOrbits orbits(system_of<VanDerPol>(), {{1, 1, 1}}, 1, start.shape, settings);
  const PathPoint point = orbits.corrected(start);
  return {orbits.result, orbits.follower.newton().history(), point.orbit};
}

}  // namespace

TEST_CASE("full Newton converges quadratically") {
  const Attempt found = attempt(1.05, {20, 20, 1e-12, 1e-12});
  REQUIRE(found.result.converged());
  CHECK(found.orbit.par(0) == 1.0);
  CHECK(std::abs(found.orbit.start(0)[0] - cycle().start(0)) < 1e-8);
  REQUIRE(found.history.size() >= 4);
  REQUIRE(found.history.size() == static_cast<std::size_t>(found.result.iterations));
  for (std::size_t k = 1; k < found.history.size(); ++k) {
    const double before = std::max(found.history[k - 1].state_change, found.history[k - 1].parameter_change);
    const double now = std::max(found.history[k].state_change, found.history[k].parameter_change);
    CHECK(now < 50 * before * before + 1e-12);
    CHECK(found.history[k].number == static_cast<int>(k) + 1);
  }
  CHECK(found.result.residual < 1e-11);
}

TEST_CASE("chord iterations converge linearly to the same orbit, with the factors of the last full one") {
  const Attempt newton = attempt(1.01, {20, 20, 1e-12, 1e-12});
  const Attempt chord = attempt(1.01, {40, 1, 1e-12, 1e-12});
  REQUIRE(chord.result.converged());
  CHECK(chord.result.iterations > newton.result.iterations);
  CHECK(mesh_point_distance(chord.orbit, newton.orbit) < 1e-10);
  CHECK(chord.result.change_since_factorization > 1e-3);
  CHECK(newton.result.change_since_factorization < 1e-11);
}

TEST_CASE("iterations end when the corrections are within both tolerances") {
  const Attempt loose = attempt(1.02, {20, 20, 1e-2, 1e-2}), tight = attempt(1.02, {20, 20, 1e-10, 1e-10});
  CHECK(loose.result.iterations < tight.result.iterations);
  CHECK(loose.history.back().parameter_change <= 1e-2);
  CHECK(loose.history.back().state_change < 1e-2);
  CHECK(tight.history.back().state_change < 1e-10);
  const Attempt parameters_only = attempt(1.02, {20, 20, 1e-10, 1e99});
  CHECK(parameters_only.history.back().parameter_change <= 1e-10);
}

TEST_CASE("too few iterations") {
  const Attempt few = attempt(1.05, {2, 2, 1e-12, 1e-12});
  CHECK(few.result.status == NewtonStatus::too_many_iterations);
  CHECK(few.result.iterations == 2);
}

TEST_CASE("corrections that grow by more than 20 end the iteration at once") {
  // Next to the fold at omega = 1.8901, v = 5.1987423726: d alpha / d v = a'' (v - v_fold). A first step of 0.01 in v
  // from a place 1e-4 beside the fold asks the next one, with the same factors, for 0.01^2 / (2 1e-4) = 50 times that.
  const double v = 5.1987423726031 + 1e-4;
  const OscillatorOrbit orbit = one_impact_orbit(1.8901, v);
  const double slope = (one_impact_orbit(1.8901, v + 1e-5).alpha - one_impact_orbit(1.8901, v - 1e-5).alpha) / 2e-5;
  Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 50, 4, orbit.par());
  start.par(0) += 0.01 * slope;
  PeriodicOrbits orbits(linosc(), {{1, 1, 1}}, 1, start.shape, {20, 1, 1e-10, 1e-10});
  orbits.corrected(start);
  CHECK(orbits.result.status == NewtonStatus::diverging);
  CHECK(orbits.result.iterations == 2);
  CHECK(describe(NewtonStatus::diverging) != describe(NewtonStatus::too_many_iterations));
}

TEST_CASE("functions that are not finite, and an exactly singular matrix") {
  CHECK(attempt(1e200, {8, 3, 1e-7, 1e-7}).result.status == NewtonStatus::not_finite);

  // A nonimpacting orbit at x = 0 with alpha = 0 and y = 0: h_x f = 0 and the column of T vanishes.
  Orbit rest{{4, 1, 10, 4}, uniform_mesh(10), Eigen::MatrixXd::Zero(4, 41), parameters({0.0, 2.0, 0.05, 0.8})};
  rest.duration(0) = pi;
  PeriodicOrbits orbits(linosc(), {{1, 2, 2}}, 1, rest.shape);
  orbits.corrected(rest);
  CHECK(orbits.result.status != NewtonStatus::converged);
}

TEST_CASE("a solution is left where it is") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 50, 5, orbit.par());
  PeriodicOrbits orbits(linosc(), {{1, 1, 1}}, 1, start.shape, {8, 3, 1e-7, 1e-7});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  CHECK(orbits.result.iterations == 1);
  CHECK(mesh_point_distance(point.orbit, start) < 1e-9);
}

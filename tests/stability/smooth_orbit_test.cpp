// A smooth system as special case: a Poincare section on the limit cycle of van der Pol's oscillator.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/multiplier_sets.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using namespace tchat::test;

TEST_CASE("van der Pol limit cycle: period, amplitude and multipliers as by integration, to 1e-9") {
  const PeriodicOrbit cycle = van_der_pol_cycle(1.0);
  REQUIRE(cycle.converged);
  const Orbit start = sampled_orbit(van_der_pol_pieces(cycle, 1.0), 2, 100, 5, parameters({1.0}));
  PeriodicOrbits orbits(system_of<VanDerPol>(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  // Order 2c = 10 in 1 / 100: the discretisation is at rounding level, the tolerance is that of the integration.
  CHECK(std::abs(point.orbit.period() - cycle.map.period) < 1e-9);
  CHECK(std::abs(point.orbit.start(0)[0] - cycle.start(0)) < 1e-9);
  const FloquetMultipliers found = orbits.multipliers(point);
  REQUIRE(found.valid);
  const Multipliers integrated(cycle.map.multipliers.begin(), cycle.map.multipliers.end());
  CHECK(absolute_distance(found.values, integrated) < 1e-9);
  CHECK(found.stable());
}

TEST_CASE("van der Pol limit cycle continued from mu = 1: period and multiplier by integration at every point") {
  const PeriodicOrbit cycle = van_der_pol_cycle(1.0);
  const Orbit start = sampled_orbit(van_der_pol_pieces(cycle, 1.0), 2, 100, 4, parameters({1.0}));
  PeriodicOrbits orbits(system_of<VanDerPol>(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint first = orbits.corrected(start);
  ContinuationSettings settings = branch_settings(start.shape, 1, -0.1, 0.3, 12);
  settings.adapt_mesh_every = 1;
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, {}, sink);
  run.run(first);
  REQUIRE(sink.points.size() == 12);
  for (const KeptPoint& p : sink.points) {
    const double mu = p.orbit.par(0);
    if (mu < 0.05) break;  // the limit cycle is born there with multiplier 1
    CAPTURE(p.number, mu);
    ShootingOptions options;
    const PeriodicOrbit reference = shoot(system_of<VanDerPol>(), {{1, 1, 1}},
                                          Eigen::Map<const Eigen::VectorXd>(p.orbit.start(0), 2), p.orbit.par, options);
    REQUIRE(reference.converged);
    CHECK(std::abs(p.orbit.period() - reference.map.period) < 1e-9);
    const Multipliers integrated(reference.map.multipliers.begin(), reference.map.multipliers.end());
    CHECK(absolute_distance(p.multipliers.values, integrated) < 1e-9);
  }
}

// A relaxation oscillation: the adapted mesh against the uniform one, and both against integration.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using namespace tchat::test;

TEST_CASE("mesh adaptation beats the uniform mesh by more than 10 on a relaxation oscillation") {
  const double mu = 8.0;
  const int intervals = 80;
  const PeriodicOrbit cycle = van_der_pol_cycle(mu);
  REQUIRE(cycle.converged);
  const Orbit start = sampled_orbit(van_der_pol_pieces(cycle, mu), 2, intervals, 4, parameters({mu}));
  PeriodicOrbits orbits(system_of<VanDerPol>(), {{1, 1, 1}}, 1, start.shape);
  PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  const auto error = [&] {
    return std::max(std::abs(point.orbit.period() - cycle.map.period),
                    std::abs(point.orbit.start(0)[0] - cycle.start(0)));
  };
  const double uniform = error();
  for (int sweep = 0; sweep < 4; ++sweep) {
    orbits.follower.change_mesh(point,
                                equidistributed_mesh(point.orbit, orbits.follower.condensed().rule(), intervals));
    REQUIRE(orbits.start(point).converged());
  }
  const double adapted = error();
  CAPTURE(uniform, adapted);
  CHECK(uniform > 1e-8);
  CHECK(adapted < uniform / 10);
  CHECK(adapted < 1e-4);
}

// Multipliers of very different size over eight segments.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/multiplier_sets.hpp"
#include "support/rotating_directions.hpp"

using namespace tchat;
using namespace tchat::test;

TEST_CASE("eight segments in rotating frames: multipliers 1e-12, 1e-3 and 1e12, each to 1e-3 of its size") {
  const double amplitude = 0.4;
  const ParameterVector par = parameters({amplitude});
  const int intervals = GENERATE(20, 50);
  const Orbit exact = sampled_orbit(RotatingDirections::pieces(amplitude), 4, intervals, 4, par);
  Orbit start = exact;
  // Newton has something to do: the start is off by what a factor of 30 per segment lets it be.
  for (Eigen::Index k = 0; k < start.states.cols(); ++k)
    start.states(0, k) += 1e-3 * std::sin(0.1 * static_cast<double>(k));
  PeriodicOrbits orbits(system_of<RotatingDirections>(), RotatingDirections::signature(), 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  const double discretisation = intervals == 20 ? 1e-6 : 1e-9;  // of b(theta), order (4 pi / N)^8
  CHECK(mesh_point_distance(point.orbit, exact) < discretisation);

  const FloquetMultipliers found = orbits.multipliers(point);
  REQUIRE(found.valid);
  CHECK(found.structural < 1e-3);
  const auto& expected = RotatingDirections::multipliers;
  CHECK(relative_distance(nontrivial(found.values, found.structural), {expected.begin(), expected.end()}) < 1e-3);
  CHECK(found.stable_count() == 3);
}

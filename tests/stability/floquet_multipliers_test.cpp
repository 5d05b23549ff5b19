// Multipliers of a nonlinear hybrid orbit of three different modes against the variational equations with saltation.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/multiplier_sets.hpp"
#include "support/three_modes.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Solved {
  PathPoint point;
  FloquetMultipliers multipliers;
};

Solved solved(const PeriodicOrbit& reference, const ParameterVector& par, int intervals, int collocation) {
  const HybridSystem& system = system_of<ThreeModes>();
  const Orbit start =
      sampled_orbit(pieces_of(system, ThreeModes::signature(), reference.map, par), 3, intervals, collocation, par);
  PeriodicOrbits orbits(system, ThreeModes::signature(), 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  const FloquetMultipliers found = orbits.multipliers(point);
  REQUIRE(found.valid);
  return {point, found};
}

}  // namespace

TEST_CASE("three different modes: orbit and multipliers as by integration") {
  const double coupling = GENERATE(0.2, 0.4, 0.8);
  ParameterVector par = ThreeModes::par();
  par(0) = coupling;
  const PeriodicOrbit reference = ThreeModes::orbit(par);
  INFO(reference.message);
  REQUIRE(reference.converged);
  const Multipliers integrated(reference.map.multipliers.begin(), reference.map.multipliers.end());
  for (const int collocation : {3, 4, 5}) {
    CAPTURE(coupling, collocation);
    const Solved found = solved(reference, par, 40, collocation);
    // Durations of order 1 on 40 intervals: the error of order 2c is 1e-10 for c = 3 and rounding beyond.
    for (int s = 0; s < 3; ++s)
      CHECK(std::abs(found.point.orbit.duration(s) - reference.map.segments[static_cast<std::size_t>(s)].duration) <
            1e-9);
    CHECK((Eigen::Map<const Eigen::VectorXd>(found.point.orbit.start(0), 3) - reference.start).cwiseAbs().maxCoeff() <
          1e-9);
    CHECK(mixed_distance(found.multipliers.values, integrated) < 1e-9);
    CHECK(found.multipliers.structural < 1e-7);
  }
}

TEST_CASE("the structural multiplier measures the mesh: it falls with the error of the flow") {
  const PeriodicOrbit reference = ThreeModes::orbit(ThreeModes::par());
  REQUIRE(reference.converged);
  const double coarse = solved(reference, ThreeModes::par(), 3, 2).multipliers.structural;
  const double fine = solved(reference, ThreeModes::par(), 12, 2).multipliers.structural;
  CHECK(coarse > 1e-8);
  CHECK(fine < coarse / 64);  // order 4 would be 256, not yet reached on three intervals
}

TEST_CASE("multipliers are listed with the one nearest to 1 first, then by distance from the unit circle") {
  const PeriodicOrbit reference = ThreeModes::orbit(ThreeModes::par());
  const FloquetMultipliers found = solved(reference, ThreeModes::par(), 20, 4).multipliers;
  REQUIRE(found.values.size() == 3);
  for (const auto& mu : found.values) CHECK(std::abs(found.values[0] - 1.0) <= std::abs(mu - 1.0));
  CHECK(std::abs(std::abs(found.values[1]) - 1) <= std::abs(std::abs(found.values[2]) - 1));
}

TEST_CASE("stability follows the rule |mu| <= 1 + 1e-5") {
  FloquetMultipliers multipliers;
  multipliers.values = {1.0 + 9e-6, {0.0, -1.0 - 9e-6}, 0.0};
  CHECK_FALSE(multipliers.stable());  // not computed
  multipliers.valid = true;
  CHECK(multipliers.stable());
  CHECK(multipliers.stable_count() == 3);
  multipliers.values[1] = {0.0, -1.0 - 2e-5};
  CHECK_FALSE(multipliers.stable());
  CHECK(multipliers.stable_count() == 2);
}

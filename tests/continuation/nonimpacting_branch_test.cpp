// The nonimpacting branch of the linear oscillator against its closed form.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/multiplier_sets.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Branch {
  int principal;  // PAR index: 1 alpha, 2 omega
  double ds, ds_max, low, high;
  int adapt_mesh_every;
};

std::vector<KeptPoint> continued(const Branch& branch) {
  const OscillatorOrbit orbit = nonimpacting_orbit(2.0, 3.0);
  const double period = orbit.constants.period();
  const Orbit start = sampled_orbit({orbit.piece(0, period)}, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), {{1, 2, 2}}, branch.principal, start.shape);
  PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, branch.principal, branch.ds, branch.ds_max, 200);
  settings.parameter_min = branch.low;
  settings.parameter_max = branch.high;
  settings.adapt_mesh_every = branch.adapt_mesh_every;
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, {}, sink);
  CHECK(run.run(point).reason == EndReason::beyond_bound);
  return sink.points;
}

}  // namespace

TEST_CASE("nonimpacting branch in omega and in alpha: displacement and multipliers at every point") {
  // omega from below the resonance to 3, alpha from small amplitudes to large ones; with and without mesh adaptation.
  const Branch branch = GENERATE(Branch{2, -0.05, 0.5, 0.7, 10.0, 0}, Branch{2, 0.05, 0.5, 0.0, 3.0, 0},
                                 Branch{2, -0.05, 0.5, 0.7, 10.0, 3}, Branch{1, -0.1, 0.2, 0.3, 10.0, 0},
                                 Branch{1, 0.1, 0.5, 0.0, 6.0, 1});
  CAPTURE(branch.principal, branch.ds, branch.adapt_mesh_every);
  const std::vector<KeptPoint> points = continued(branch);
  REQUIRE(points.size() > 8);
  double farthest = 0.0;
  for (const KeptPoint& point : points) {
    const double alpha = point.orbit.par(0), omega = point.orbit.par(1);
    CAPTURE(point.number, alpha, omega);
    farthest = std::max(farthest, std::abs(alpha - 3.0) + std::abs(omega - 2.0));
    // The start is a mesh point, where the error of c = 4 is of order (omega_d T / N)^8 < 1e-9.
    const double largest = alpha / std::abs(OscillatorConstants{omega}.stiffness());
    CHECK(std::abs(point.orbit.start(0)[0] - largest) < 1e-9 * largest);
    CHECK(std::abs(point.orbit.period() - 2 * pi / omega) < 1e-9);
    // The same order for the flow Jacobian, times |f| / |h_x f| for its projection.
    REQUIRE(point.multipliers.valid);
    CHECK(absolute_distance(point.multipliers.values, nonimpacting_multipliers(omega)) < 1e-8);
    CHECK(std::abs(point.multipliers.structural) < 1e-8);
    CHECK(point.multipliers.stable());
    CHECK(point.violations.empty());
  }
  CHECK(farthest > 0.9);
}

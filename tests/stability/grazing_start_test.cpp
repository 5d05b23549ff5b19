// Continuation from the grazing orbit itself, h_x f = 0 at the impact.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/multiplier_sets.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double omega = 2.0072;

std::vector<KeptPoint> from_grazing(double ds) {
  const OscillatorOrbit orbit = one_impact_orbit(omega, 0.0);
  const Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), {{1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, ds, 0.2, 25);
  settings.monitored = {{1}};
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, {}, sink);
  CHECK(run.run(point).reason == EndReason::max_points);
  return sink.points;
}

}  // namespace

TEST_CASE("closed form of the grazing orbit") {
  const OscillatorOrbit orbit = one_impact_orbit(omega, 0.0);
  CHECK(orbit.alpha == Approx(std::abs(orbit.constants.stiffness())).epsilon(1e-14));
  CHECK(orbit.u0.norm() == 0.0);
}

TEST_CASE("from grazing both ways: admissible where the impact velocity is positive, multipliers always finite") {
  const double ds = GENERATE(1e-3, -1e-3, 1e-5, -1e-5);
  CAPTURE(ds);
  const std::vector<KeptPoint> points = from_grazing(ds);
  REQUIRE(points.size() == 25);
  const double alpha_slope = one_impact_orbit(omega, 1e-3).alpha - one_impact_orbit(omega, 0.0).alpha;
  for (const KeptPoint& point : points) {
    const double v = point.orbit.end(0)[1];
    CAPTURE(point.number, v);
    REQUIRE(point.multipliers.valid);
    REQUIRE(point.multipliers.values.size() == 4);
    for (const auto& mu : point.multipliers.values) {
      CHECK(std::isfinite(mu.real()));
      CHECK(std::isfinite(mu.imag()));
      CHECK(std::abs(mu) <= 1.0000001e99);
    }
    if (point.number == 1) continue;
    // DS > 0 lets alpha grow; the branch passes smoothly through v = 0.
    CHECK((v > 0.0) == (ds * alpha_slope > 0.0));
    CHECK(std::abs(point.orbit.par(0) - one_impact_orbit(omega, v).alpha) < 1e-9);
    if (v > 0.0) {
      CHECK(point.violations.empty());
    } else {
      REQUIRE_FALSE(point.violations.empty());
      CHECK(describe(point.violations.back(), linosc()).find("h_x f") != std::string::npos);
    }
    // Errors of the states of 1e-10 count as 1e-10 / |v| relative to the unbounded multiplier.
    if (std::abs(v) > 1e-4)
      CHECK(mixed_distance(point.multipliers.values, one_impact_multipliers(omega, v)) < 1e-7 + 1e-9 / std::abs(v));
  }
}

TEST_CASE("at grazing the multiplier that is infinite is printed as 1e99, the others are those of the limit") {
  const KeptPoint start = from_grazing(1e-3).front();
  CHECK(std::abs(start.orbit.end(0)[1]) < 1e-10);
  CHECK(start.violations.empty());
  Multipliers values = start.multipliers.values;
  const auto infinite = std::find(values.begin(), values.end(), std::complex<double>(1e99));
  REQUIRE(infinite != values.end());
  values.erase(infinite);
  // As v -> 0 the other nontrivial multiplier goes to zero like det M / mu ~ v; exp(-2T) stays.
  const double limit_cycle = std::exp(-2 * start.orbit.period());
  double nearest = INFINITY;
  for (const auto& mu : values) {
    CHECK(std::abs(mu) < 1.0);
    nearest = std::min(nearest, std::abs(mu - limit_cycle));
  }
  CHECK(nearest < 1e-8);
}

namespace {

/// Van der Pol's oscillator with a wall at x1 = PAR(2), that returns the velocity times -0.8.
struct WallOscillator : VanDerPol {
  static constexpr int parameters = 2, events = 2, jumps = 2;
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? x[1] : T(p[1] - x[0]);
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? x[1] : T(-0.8 * x[1]);
  }
};

}  // namespace

TEST_CASE("in the plane the multiplier at grazing is 0/0: left out there, beside it near its limit") {
  const double mu = 0.2;
  const PeriodicOrbit cycle = van_der_pol_cycle(mu);
  REQUIRE(cycle.converged);
  const double smooth = cycle.map.multipliers.cwiseAbs().maxCoeff();
  const Orbit grazing =
      sampled_orbit(van_der_pol_pieces(cycle, mu), 2, 40, 4, parameters({mu, cycle.map.segments[0].start(0)}));
  PeriodicOrbits orbits(system_of<WallOscillator>(), {{1, 2, 2}}, 2, grazing.shape);
  PathPoint start = orbits.follower.make_point(grazing);
  REQUIRE(orbits.follower.start_by_minimum_norm(start).converged());
  const FloquetMultipliers at_grazing = orbits.multipliers(start);
  REQUIRE(std::abs(start.orbit.end(0)[1]) < 1e-8);
  CHECK(at_grazing.valid);
  CHECK(at_grazing.undetermined == 1);
  CHECK(at_grazing.values.size() == 1);  // the structural one
  CHECK_FALSE(at_grazing.determined());
  // r squared times that of the cycle, for low velocities.
  PathPoint beside = orbits.follower.make_point(grazing);
  for (const double ds : {3e-3, -3e-3}) {
    REQUIRE(orbits.follower.step(start, ds, beside).converged());
    const FloquetMultipliers multipliers = orbits.multipliers(beside);
    REQUIRE(multipliers.determined());
    REQUIRE(multipliers.values.size() == 2);
    CHECK(std::abs(multipliers.values[0]) == Approx(0.64 * smooth).epsilon(0.05));
  }
}

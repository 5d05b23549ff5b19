// Steps along fold, period-doubling and torus curves begin from their point only: failed trials leave no trace.
#include <catch2/catch.hpp>

#include "continuation/path_follower.hpp"
#include "impacting_orbits.hpp"
#include "langford.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/periodic_orbit_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr NewtonSettings newton{9, 3, 1e-10, 1e-10};

Orbit impacting(const OscillatorOrbit& orbit) { return sampled_orbit(whole(orbit).pieces, 4, 30, 4, orbit.par()); }

bool equal(const Orbit& a, const Orbit& b) { return a.states == b.states && a.par == b.par; }

/// Steps of 0.02 both ways, bit for bit the same whatever was tried before them.
void check_steps(const HybridSystem& hybrid, const Orbit& start,
                 const std::function<std::unique_ptr<OrbitCondition>(const DefiningSystem&)>& condition) {
  const PeriodicOrbitSystem system(hybrid, {{1, 1, 1}}, {1, 2});
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), newton, 1, condition(system));
  PathPoint from = follower.make_point(start);
  REQUIRE(follower.start_by_minimum_norm(from).converged());
  PathPoint next = from;
  REQUIRE(follower.step(from, 0.02, next).converged());
  PathPoint back = from;
  REQUIRE(follower.step(from, -0.02, back).converged());
  PathPoint trial = from;
  int failed = 0;
  for (const double ds : {0.5, -1.0, 3.0, -10.0, 40.0, 1e3, -1e6}) {
    CAPTURE(ds);
    failed += follower.step(from, ds, trial).converged() ? 0 : 1;
    REQUIRE(follower.step(from, 0.02, trial).converged());
    CHECK(equal(trial.orbit, next.orbit));
    follower.step(from, ds, trial);
    REQUIRE(follower.step(from, -0.02, trial).converged());
    CHECK(equal(trial.orbit, back.orbit));
  }
  CHECK(failed > 0);

  // The start too.
  PathPoint again = follower.make_point(start);
  REQUIRE(follower.start_by_minimum_norm(again).converged());
  CHECK(equal(again.orbit, from.orbit));
}

}  // namespace

TEST_CASE("a step along a torus curve does not depend on failed trials") {
  const LangfordCircle circle = LangfordCircle{}.at_torus();
  const Orbit start = circle.orbit(30, 4);
  check_steps(system_of<Langford>(), start, [&](const DefiningSystem& system) {
    return std::make_unique<CriticalPair>(system, start.shape, circle.multiplier());
  });
}

TEST_CASE("a step along a fold or period-doubling curve does not depend on failed trials") {
  struct Kind {
    int multiplier;
    double omega, v;
  };
  const Kind kind = GENERATE(Kind{-1, 2.0072, period_doubling_velocity()}, Kind{1, 1.8901, fold_velocity()});
  const Orbit start = impacting(one_impact_orbit(kind.omega, kind.v));
  CAPTURE(kind.multiplier);
  check_steps(linosc(), start, [&](const DefiningSystem& system) {
    return std::make_unique<CriticalMultiplier>(system, start.shape, kind.multiplier);
  });
}

// Starting and stepping along a branch: lengths, directions, folds.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const Signature impacting{{1, 1, 1}};
const OrbitShape shape{4, 1, 50, 4};

Orbit closed_form(double omega, double v) {
  const OscillatorOrbit orbit = one_impact_orbit(omega, v);
  return sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 50, 4, orbit.par());
}

}  // namespace

TEST_CASE("the tangent is a unit vector along the branch, alpha growing") {
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  const PathPoint point = orbits.corrected(closed_form(2.0072, 0.5));
  REQUIRE(orbits.result.converged());
  CHECK(dot(point.dual, point.tangent) == Approx(1.0).epsilon(1e-12));
  CHECK(orbits.follower.principal_direction(point) > 0.0);
  // The closed form differentiated: d v / d alpha.
  const double h = 1e-5;
  const double slope = 2 * h / (one_impact_orbit(2.0072, 0.5 + h).alpha - one_impact_orbit(2.0072, 0.5 - h).alpha);
  const Eigen::Index last = point.tangent.states.cols() - 1;
  CHECK(point.tangent.states(1, last) / point.tangent.globals(0) == Approx(slope).epsilon(1e-7));
  CHECK(std::abs(point.tangent.durations(0)) < 1e-9);  // T = 2 pi / omega along the branch

  PathPoint reversed = point;
  orbits.follower.reverse(reversed);
  CHECK(orbits.follower.alignment(point, reversed.tangent) == Approx(-1.0).epsilon(1e-12));
  OrbitVector longer = point.tangent;
  longer.scale(17.0);
  CHECK(orbits.follower.alignment(point, longer) == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("a step has exactly the wanted length along the tangent, and the way back leads home") {
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  const PathPoint from = orbits.corrected(closed_form(1.8901, 1.0));
  PathPoint to = from, back = from;
  for (const double ds : {0.3, -0.3, 1e-4}) {
    REQUIRE(orbits.follower.step(from, ds, to).converged());
    CHECK(dot_difference(from.dual, to.orbit, from.orbit, {1}) == Approx(ds).epsilon(1e-9));
    CHECK(dot(from.dual, to.tangent) > 0.0);  // orientation is kept
    const double length = dot_difference(to.dual, from.orbit, to.orbit, {1});
    REQUIRE(orbits.follower.step(to, length, back).converged());
    CHECK((back.orbit.states - from.orbit.states).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("through a fold: alpha turns, the orientation does not") {
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  PathPoint here = orbits.corrected(closed_form(1.8901, 4.0));
  orbits.follower.reverse(here);  // v grows as alpha falls towards the fold at v = 5.1987
  PathPoint next = here;
  int turns = 0;
  for (int k = 0; k < 12; ++k) {
    REQUIRE(orbits.follower.step(here, 0.25, next).converged());
    turns += here.tangent.globals(0) * next.tangent.globals(0) < 0.0;
    CHECK(next.orbit.end(0)[1] > here.orbit.end(0)[1]);
    CHECK(std::abs(next.orbit.par(0) - one_impact_orbit(1.8901, next.orbit.end(0)[1]).alpha) < 1e-9);
    std::swap(here, next);
  }
  CHECK(turns == 1);
  CHECK(here.orbit.end(0)[1] > 5.3);
}

TEST_CASE("a start on a fold needs minimum-norm steps") {
  // The fold of the published table.
  const double v = 5.1987423726031, alpha = 1.9706026714368;
  Orbit start = closed_form(1.8901, v);
  CHECK(start.par(0) == Approx(alpha).epsilon(1e-12));
  start.states.row(0) *= 1.001;
  start.par(0) -= 1e-3;  // there is no orbit at this alpha
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  orbits.corrected(start);
  CHECK_FALSE(orbits.result.converged());
  PathPoint point = orbits.follower.make_point(start);
  REQUIRE(orbits.follower.start_by_minimum_norm(point).converged());
  const double found = point.orbit.end(0)[1];
  CHECK(std::abs(found - v) < 0.1);
  CHECK(std::abs(point.orbit.par(0) - one_impact_orbit(1.8901, found).alpha) < 1e-9);
  CHECK(dot(point.dual, point.tangent) == Approx(1.0).epsilon(1e-12));
}

TEST_CASE("a start along a stored direction keeps its side, and its place when it is a solution") {
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  const PathPoint known = orbits.corrected(closed_form(2.0072, 0.5));
  for (const double sign : {1.0, -1.0}) {
    PathPoint point = orbits.follower.make_point(known.orbit);
    OrbitVector direction = known.tangent;
    direction.scale(sign * 3.0);
    const NewtonResult result = orbits.follower.start_along(point, direction);
    REQUIRE(result.converged());
    CHECK(result.iterations == 1);
    CHECK(sign * dot(known.dual, point.tangent) == Approx(1.0).epsilon(1e-9));
    CHECK(std::abs(point.orbit.par(0) - known.orbit.par(0)) < 1e-11);
  }
}

TEST_CASE("a new mesh keeps the function and a unit tangent") {
  PeriodicOrbits orbits(linosc(), impacting, 1, shape);
  PathPoint point = orbits.corrected(closed_form(2.0072, 2.0));
  const Orbit before = point.orbit;
  const std::vector<double> mesh =
      equal_parts(before.mesh, Eigen::VectorXd::LinSpaced(shape.intervals, 1.0, 2.0), shape.intervals);
  orbits.follower.change_mesh(point, mesh);
  CHECK(point.orbit.mesh == mesh);
  CHECK(dot(point.dual, point.tangent) == Approx(1.0).epsilon(1e-12));
  const OscillatorOrbit exact = one_impact_orbit(2.0072, 2.0);
  const Orbit closed = sampled_orbit({exact.piece(0, exact.constants.period())}, 4, 50, 4, exact.par(), mesh);
  CHECK((point.orbit.states - closed.states).cwiseAbs().maxCoeff() < 1e-6);  // order c + 1 between old mesh points
}

TEST_CASE("the duration as continuation parameter") {
  const OscillatorOrbit exact = nonimpacting_orbit(2.0, 3.0);
  const Orbit start = sampled_orbit({exact.piece(0, pi)}, 4, 50, 4, exact.par());
  const PeriodicOrbitSystem system(linosc(), {{1, 2, 2}}, {2});
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), tight_newton(),
                        ParameterLayout().first_duration());
  PathPoint point = follower.make_point(start);
  point.orbit.duration(0) = 3.0;
  REQUIRE(follower.start_at_fixed_parameter(point).converged());
  CHECK(point.orbit.duration(0) == Approx(3.0).epsilon(1e-13));
  CHECK(point.orbit.par(1) == Approx(2 * pi / 3.0).epsilon(1e-9));
  CHECK(follower.principal_direction(point) == point.tangent.durations(0));
  CHECK(point.tangent.durations(0) > 0.0);
}

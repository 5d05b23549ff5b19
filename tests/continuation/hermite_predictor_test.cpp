// Predictions with the points before: their order, that they change nothing but the work, and what is done without
// them.
#include <catch2/catch.hpp>
#include <cmath>

#include "continuation/predictor.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const std::vector<int> alpha{1};
const OrbitShape shape{4, 1, 40, 4};

/// The impacting branch at omega = 1.8901, towards its fold at v = 5.1987: alpha turns there, the orbit goes on.
struct Branch {
  Branch() : orbits(linosc(), {{1, 1, 1}}, 1, shape), here(start()), next(here) {}

  PathPoint start() {
    const OscillatorOrbit orbit = one_impact_orbit(1.8901, 4.0);
    PathPoint point =
        orbits.corrected(sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, shape.intervals, 4, orbit.par()));
    REQUIRE(orbits.result.converged());
    orbits.follower.reverse(point);
    return point;
  }
  NewtonResult step(double ds) {
    const NewtonResult result = orbits.follower.step(here, ds, next);
    REQUIRE(result.converged());
    std::swap(here, next);
    return result;
  }
  /// Of the prediction by the points before `here`, from the point that Newton's method finds.
  double error(double ds) {
    PathPoint predicted = here;
    if (HermitePredictor(orbits.system).predict(here, ds, predicted.orbit).error == 0.0)
      advance(predicted.orbit, ds, here.tangent, alpha);
    PathPoint found = here;
    REQUIRE(orbits.follower.step(here, ds, found).converged());
    return (found.orbit.states - predicted.orbit.states).cwiseAbs().maxCoeff();
  }

  PeriodicOrbits orbits;
  PathPoint here;
  PathPoint next;
};

}  // namespace

TEST_CASE("a prediction with K points before has an error of order 2 K + 2") {
  for (const int points : {0, 1, 2}) {
    const auto error = [&](double ds) {
      Branch branch;
      for (int k = 0; k < points; ++k) branch.step(ds);
      return branch.error(ds);
    };
    const double large = error(0.4);
    const double small = error(0.2);
    CAPTURE(points, large, small);
    REQUIRE(small > 1e-12);  // beyond rounding
    CHECK(std::log2(large / small) > 2 * points + 1.3);
    CHECK(std::log2(large / small) < 2 * points + 3.0);
  }
}

TEST_CASE("the points reached are those reached from the tangent, mostly with one matrix") {
  Branch branch;
  PathPoint plain = branch.here;
  int served_by_one = 0;
  for (int k = 0; k < 30; ++k) {
    PathPoint without = branch.here;
    without.trail.clear();
    REQUIRE(branch.orbits.follower.step(without, 0.06, plain).converged());
    const int iterations = static_cast<int>(branch.orbits.follower.newton().history().size());
    const NewtonResult result = branch.step(0.06);
    CAPTURE(k);
    CHECK((branch.here.orbit.states - plain.orbit.states).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(std::abs(branch.here.orbit.par(0) - plain.orbit.par(0)) < 1e-9);
    CHECK((branch.here.tangent.states - plain.tangent.states).cwiseAbs().maxCoeff() < 1e-8);
    if (k < 3) continue;
    CHECK_FALSE(result.from_tangent);
    CHECK(branch.orbits.follower.newton().history().front().larger() <= 1e-8);
    served_by_one += branch.orbits.follower.newton().history().front().larger() <= 1e-10;  // tangent and all
    CHECK(iterations >= 2);
  }
  CHECK(served_by_one >= 13);  // of 27
}

TEST_CASE("what Newton's method would need from the tangent is known without trying it") {
  int told_surely = 0;
  for (const double ds : {0.01, 0.02, 0.03, 0.06, 0.1, 0.2}) {
    Branch branch;
    for (int k = 0; k < 3; ++k) branch.step(ds);
    PathPoint reached = branch.here;
    const NewtonResult from_tangent = branch.orbits.follower.step_along_tangent(branch.here, ds, reached);
    REQUIRE(from_tangent.converged());
    const double constant = reached.newton_constant;
    REQUIRE_FALSE(branch.orbits.follower.step(branch.here, ds, reached).from_tangent);
    const IterationRange exactly = branch.orbits.follower.iterations_along_tangent(branch.here, ds, reached, true);
    branch.here.newton_constant = constant;
    const IterationRange estimated = branch.orbits.follower.iterations_along_tangent(branch.here, ds, reached, false);
    CAPTURE(ds, from_tangent.iterations, exactly.least, exactly.most, estimated.least, estimated.most);
    for (const IterationRange& range : {exactly, estimated}) {
      CHECK(range.least <= from_tangent.iterations);
      CHECK(range.most >= from_tangent.iterations);
    }
    told_surely += exactly.least == exactly.most;
  }
  CHECK(told_surely >= 4);  // of 6
}

TEST_CASE("points that are not on the branch do not keep Newton's method from it") {
  Branch branch;
  for (int k = 0; k < 2; ++k) branch.step(0.2);
  PathPoint good = branch.here;
  REQUIRE(branch.orbits.follower.step(branch.here, 0.2, good).converged());
  for (const double size : {1e-3, 0.1, 10.0}) {
    PathPoint wrong = branch.here;
    wrong.orbit.states.row(0).array() += size;
    PathPoint misled = branch.here;
    advance(wrong.orbit, -0.3, misled.tangent, alpha);
    misled.trail.add(wrong, alpha);
    PathPoint reached = misled;
    CAPTURE(size);
    REQUIRE(branch.orbits.follower.step(misled, 0.2, reached).converged());
    CHECK((reached.orbit.states - good.orbit.states).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("a trail moves to another mesh with its point") {
  Branch branch;
  for (int k = 0; k < 3; ++k) branch.step(0.1);
  const PathTrail before = branch.here.trail;
  std::vector<double> mesh = branch.here.orbit.mesh;
  for (std::size_t j = 1; j + 1 < mesh.size(); ++j) mesh[j] += 0.002 * std::sin(0.7 * static_cast<double>(j));
  branch.orbits.follower.change_mesh(branch.here, mesh);
  CHECK(branch.here.trail.mesh() == mesh);
  REQUIRE(branch.here.trail.count() == before.count());
  const Eigen::Index last = branch.here.orbit.states.cols() - 1;  // the ends stay where they are
  for (int k = 0; k < before.count(); ++k)
    CHECK((branch.here.trail.mark(k).place.states.col(last) - before.mark(k).place.states.col(last)).norm() < 1e-12);
  CHECK(branch.error(0.1) < 1e-5);  // that of the interpolation between meshes; 1e-3 along the tangent
}

TEST_CASE("points share what their trails have in common, and never change each other's") {
  Branch branch;
  for (int k = 0; k < 3; ++k) branch.step(0.1);
  PathPoint copy = branch.here, assigned = branch.next;
  assigned = branch.here;
  REQUIRE(copy.trail.count() == 3);
  std::vector<Eigen::MatrixXd> places, tangents;
  for (int k = 0; k < 3; ++k) {
    places.push_back(copy.trail.mark(k).place.states);
    tangents.push_back(copy.trail.mark(k).tangent.states);
  }
  PathPoint first = copy;
  REQUIRE(branch.orbits.follower.step(copy, 0.1, first).converged());

  for (int k = 0; k < 6; ++k) branch.step(0.1);  // twice as many as a trail remembers
  std::vector<double> mesh = branch.here.orbit.mesh;
  mesh[1] *= 0.9;
  branch.orbits.follower.change_mesh(branch.here, mesh);
  PathPoint cleared = copy;
  cleared.trail.clear();
  CHECK(cleared.trail.empty());
  cleared.trail.add(branch.next, alpha);
  CHECK(cleared.trail.count() == 1);
  for (const PathPoint* point : {&copy, &assigned}) {
    REQUIRE(point->trail.count() == 3);
    for (int k = 0; k < 3; ++k) {
      CHECK(point->trail.mark(k).place.states == places[static_cast<std::size_t>(k)]);
      CHECK(point->trail.mark(k).tangent.states == tangents[static_cast<std::size_t>(k)]);
    }
    PathPoint again = *point;
    REQUIRE(branch.orbits.follower.linearize_at(*point));  // the factors that the first step had
    REQUIRE(branch.orbits.follower.step(*point, 0.1, again).converged());
    CHECK((again.orbit.states - first.orbit.states).cwiseAbs().maxCoeff() < 1e-11);
    CHECK(again.trail.mark(0).place.states == point->orbit.states);
    CHECK(again.trail.mark(1).place.states == places[0]);
  }
}

// Labelled solutions that are one orbit, and others that nearly are.
#include "explore/orbit_catalogue.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "settings/problem_type.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Of segments that end in the columns of `ends` (n x m) and begin at 0.
LabelledSolution cut_orbit(const MatrixXd& ends) {
  LabelledSolution solution;
  solution.problem_type = periodic_orbit.number;
  solution.dimension = static_cast<int>(ends.rows());
  solution.tau = {0.0, 1.0};
  solution.states = MatrixXd::Zero(ends.size(), 2);
  solution.states.col(1) = Eigen::Map<const VectorXd>(ends.data(), ends.size());
  return solution;
}

/// (a cos(t + shift), b sin(t + shift)), in 20 intervals of 4 points, moved by `by`.
LabelledSolution ellipse(double a, double b, double shift, double by = 0.0) {
  LabelledSolution solution;
  solution.problem_type = periodic_orbit.number;
  solution.dimension = 2;
  solution.mesh_intervals = 20;
  solution.collocation_points = 4;
  solution.states.resize(2, 81);
  for (int k = 0; k <= 80; ++k) {
    const double t = k / 80.0, angle = 2.0 * std::acos(-1.0) * t + shift;
    solution.tau.push_back(t);
    solution.states.col(k) = Eigen::Vector2d(a * std::cos(angle) + by, b * std::sin(angle));
  }
  return solution;
}

double distance(const LabelledSolution& a, const SignatureWord& of_a, const LabelledSolution& b,
                const SignatureWord& of_b, const std::vector<Eigen::Index>& drifting = {}) {
  return orbit_distance({&a, of_a}, {&b, of_b}, drifting);
}

const SignatureWord clock{{1, 1, 1}}, twice{{1, 1, 1}, {1, 1, 1}}, smooth{{1, 0, 0}};
const SignatureWord impact_first{{1, 1, 1}, {1, 2, 2}}, impact_last{{1, 2, 2}, {1, 1, 1}};

}  // namespace

TEST_CASE("an orbit is the same wherever its signature begins, and no orbit of the other order of events") {
  const MatrixXd ends{{1.0, 2.0}, {0.5, -3.0}};
  const MatrixXd rotated{{2.0, 1.0}, {-3.0, 0.5}};
  CHECK(distance(cut_orbit(ends), impact_first, cut_orbit(ends), impact_first) == 0.0);
  CHECK(distance(cut_orbit(ends), impact_first, cut_orbit(rotated), impact_last) == 0.0);
  CHECK(distance(cut_orbit(ends), impact_first, cut_orbit(rotated), impact_first) > 0.1);
}

TEST_CASE("a curve is the same orbit whatever events cut it, and another one where its points lie elsewhere") {
  const LabelledSolution orbit = ellipse(2.0, 1.0, 0.0);
  LabelledSolution halves = orbit;  // two segments, each with every other node
  halves.tau.clear();
  halves.states.resize(4, 41);
  for (int k = 0; k <= 40; ++k) {
    halves.tau.push_back(k / 40.0);
    halves.states.col(k) << orbit.states.col(k), orbit.states.col(k + 40);
  }
  CHECK(distance(orbit, clock, halves, impact_first) < 1e-5);
  CHECK(distance(halves, impact_first, orbit, clock) < 1e-5);
  CHECK(distance(ellipse(2.001, 1.0, 0.3), clock, halves, impact_first) > 1e-4);
  // Half of a curve lies on all of it.
  LabelledSolution half = halves;
  half.states.bottomRows(2) = half.states.topRows(2).eval();
  CHECK(distance(half, impact_first, orbit, clock) > 0.1);
}

TEST_CASE("a reflection that makes one orbit of the other, with the states that change their signs") {
  const LabelledSolution orbit = ellipse(2.0, 1.0, 0.0, 3.0);
  LabelledSolution other = orbit;
  other.states.row(0) *= -1.0;
  const auto found = reflection(orbit, other, {}, 1e-5);
  REQUIRE(found.has_value());
  CHECK((*found)[0]);
  other.states.row(0).array() += 0.01;
  CHECK_FALSE(reflection(orbit, other, {}, 1e-5).has_value());
  CHECK_FALSE(reflection(orbit, ellipse(2.0, 1.1, 0.0, -3.0), {}, 1e-5).has_value());
}

TEST_CASE("an orbit that is run twice is the same, a doubled one is not") {
  const MatrixXd once{{1.0}, {0.5}};
  const MatrixXd run_twice{{1.0, 1.0}, {0.5, 0.5}};
  const MatrixXd doubled{{1.0004, 0.9996}, {0.5, 0.5}};
  CHECK(distance(cut_orbit(once), clock, cut_orbit(run_twice), twice) == 0.0);
  CHECK(distance(cut_orbit(run_twice), twice, cut_orbit(once), clock) == 0.0);
  CHECK(distance(cut_orbit(once), clock, cut_orbit(doubled), twice) == Approx(4e-4).epsilon(1e-3));
}

TEST_CASE("mirror images, whose means and largest values may be equal, are two orbits") {
  const MatrixXd up{{1.0, -1.0}, {0.2, 0.2}}, down{{-1.0, 1.0}, {0.2, -0.2}};
  CHECK(distance(cut_orbit(up), twice, cut_orbit(-up), twice) == Approx(2.0));
  CHECK(distance(cut_orbit(up), twice, cut_orbit(down), twice) == Approx(2.0));
}

TEST_CASE("a state that nothing depends on may lie elsewhere") {
  const MatrixXd here{{1.0}, {0.5}, {3.0}}, there{{1.0}, {0.5}, {300.0}};
  CHECK(distance(cut_orbit(here), clock, cut_orbit(there), clock, {2}) == 0.0);
  CHECK(distance(cut_orbit(here), clock, cut_orbit(there), clock) > 1.0);
}

TEST_CASE("a smooth orbit is the same curve wherever it begins") {
  const LabelledSolution orbit = ellipse(2.0, 1.0, 0.0);
  CHECK(distance(orbit, smooth, ellipse(2.0, 1.0, 1.234), smooth) < 1e-5);
  CHECK(distance(orbit, smooth, ellipse(2.0, 1.0, 0.01), smooth) < 1e-5);
  CHECK(distance(orbit, smooth, ellipse(2.001, 1.0, 1.234), smooth) > 1e-4);
  CHECK(distance(orbit, smooth, ellipse(2.0, 1.0, 1.234, 5e-4), smooth) > 1e-4);
}

TEST_CASE("equilibria are compared by their state, tori not at all") {
  LabelledSolution rest = cut_orbit(MatrixXd{{1.0}, {0.5}}), other = cut_orbit(MatrixXd{{1.0}, {0.501}});
  for (LabelledSolution* const one : {&rest, &other}) {
    one->problem_type = equilibrium.number;
    one->states = one->states.rightCols(1).eval();
  }
  CHECK(distance(rest, {}, rest, {}) == 0.0);
  CHECK(distance(rest, {}, other, {}) == Approx(2e-3));
  rest.problem_type = other.problem_type = invariant_torus.number;
  CHECK(distance(rest, {}, rest, {}) == INFINITY);
}

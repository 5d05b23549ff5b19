// Periodic orbits that are one, and others that nearly are.
#include "motion/orbit_identity.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "model/scales.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The sizes of its differences are those of its states.
ComparedOrbit cut_orbit(const Signature& signature, const MatrixXd& ends) {
  return {signature, ends, ends.cwiseAbs().rowwise().maxCoeff(), {}, {}, NAN};
}

/// Extremes of the nodes give the sizes; the last node of each segment is its end.
ComparedOrbit curve(const Signature& signature, const std::vector<MatrixXd>& segments) {
  ComparedOrbit orbit{signature, {}, {}, segments, {}, NAN};
  const auto nodes = static_cast<int>(segments.front().cols());
  for (int k = 0; k < nodes; ++k) orbit.tau.push_back(k / (nodes - 1.0));
  orbit.ends.resize(segments.front().rows(), std::ssize(segments));
  MatrixXd all(segments.front().rows(), nodes * std::ssize(segments));
  for (Eigen::Index s = 0; s < std::ssize(segments); ++s) {
    all.middleCols(s * nodes, nodes) = segments[static_cast<std::size_t>(s)];
    orbit.ends.col(s) = segments[static_cast<std::size_t>(s)].rightCols(1);
  }
  orbit.sizes = sizes_of_differences(all.rowwise().minCoeff(), all.rowwise().maxCoeff(), {});
  return orbit;
}

/// (a cos(t + shift), b sin(t + shift)), in 20 intervals of 4 points, moved by `by`.
MatrixXd ellipse(double a, double b, double shift, double by = 0.0) {
  MatrixXd states(2, 81);
  for (int k = 0; k <= 80; ++k) {
    const double angle = 2.0 * std::acos(-1.0) * k / 80.0 + shift;
    states.col(k) = Eigen::Vector2d(a * std::cos(angle) + by, b * std::sin(angle));
  }
  return states;
}

const Signature clock{{1, 1, 1}}, twice{{1, 1, 1}, {1, 1, 1}}, smooth{{1, 0, 0}};
const Signature impact_first{{1, 1, 1}, {1, 2, 2}}, impact_last{{1, 2, 2}, {1, 1, 1}};

}  // namespace

TEST_CASE("an orbit is the same wherever its signature begins, and no orbit of the other order of events") {
  const MatrixXd ends{{1.0, 2.0}, {0.5, -3.0}};
  const MatrixXd rotated{{2.0, 1.0}, {-3.0, 0.5}};
  CHECK(orbit_distance(cut_orbit(impact_first, ends), cut_orbit(impact_first, ends)) == 0.0);
  CHECK(orbit_distance(cut_orbit(impact_first, ends), cut_orbit(impact_last, rotated)) == 0.0);
  CHECK(orbit_distance(cut_orbit(impact_first, ends), cut_orbit(impact_first, rotated)) > 0.1);
  CHECK(compare_cuts(cut_orbit(impact_first, ends), cut_orbit(impact_last, rotated)).shift == 1);
}

TEST_CASE("a curve is the same orbit whatever events cut it, and another one where its points lie elsewhere") {
  const MatrixXd nodes = ellipse(2.0, 1.0, 0.0);
  const ComparedOrbit orbit = curve(clock, {nodes});
  const ComparedOrbit halves = curve(impact_first, {nodes.leftCols(41), nodes.rightCols(41)});
  CHECK(orbit_distance(orbit, halves) < 1e-5);
  CHECK(orbit_distance(halves, orbit) < 1e-5);
  CHECK(orbit_distance(curve(clock, {ellipse(2.001, 1.0, 0.3)}), halves) > 1e-4);
  // Half of a curve lies on all of it.
  CHECK(orbit_distance(curve(impact_first, {nodes.leftCols(41), nodes.leftCols(41)}), orbit) > 0.1);
}

TEST_CASE("a reflection that makes one orbit of the other, with the states that change their signs") {
  const MatrixXd nodes = ellipse(2.0, 1.0, 0.0, 3.0);
  const ComparedOrbit orbit = curve(clock, {nodes});
  MatrixXd other = nodes;
  other.row(0) *= -1.0;
  const auto found = reflection(orbit, curve(clock, {other}), 1e-5);
  REQUIRE(found.has_value());
  CHECK((*found)[0]);
  other.row(0).array() += 0.01;
  CHECK_FALSE(reflection(orbit, curve(clock, {other}), 1e-5).has_value());
  CHECK_FALSE(reflection(orbit, curve(clock, {ellipse(2.0, 1.1, 0.0, -3.0)}), 1e-5).has_value());
}

TEST_CASE("an orbit that is run twice is the same, a doubled one is not") {
  const MatrixXd once{{1.0}, {0.5}};
  const MatrixXd run_twice{{1.0, 1.0}, {0.5, 0.5}};
  const MatrixXd doubled{{1.0004, 0.9996}, {0.5, 0.5}};
  CHECK(orbit_distance(cut_orbit(clock, once), cut_orbit(twice, run_twice)) == 0.0);
  CHECK(orbit_distance(cut_orbit(twice, run_twice), cut_orbit(clock, once)) == 0.0);
  CHECK(orbit_distance(cut_orbit(clock, once), cut_orbit(twice, doubled)) == Approx(4e-4).epsilon(1e-3));
}

TEST_CASE("mirror images, whose means and largest values may be equal, are two orbits") {
  const MatrixXd up{{1.0, -1.0}, {0.2, 0.2}}, down{{-1.0, 1.0}, {0.2, -0.2}};
  CHECK(orbit_distance(cut_orbit(twice, up), cut_orbit(twice, -up)) == Approx(2.0));
  CHECK(orbit_distance(cut_orbit(twice, up), cut_orbit(twice, down)) == Approx(2.0));
}

TEST_CASE("a state that nothing depends on may lie elsewhere") {
  ComparedOrbit here = cut_orbit(clock, MatrixXd{{1.0}, {0.5}, {3.0}});
  const ComparedOrbit there = cut_orbit(clock, MatrixXd{{1.0}, {0.5}, {300.0}});
  CHECK(orbit_distance(here, there) > 0.9);
  here.sizes(2) = INFINITY;
  CHECK(orbit_distance(here, there) == 0.0);
}

TEST_CASE("a small state beside a large one is compared in its own size") {
  const MatrixXd nodes = ellipse(2.0, 1.0, 0.0);
  const auto in_units = [](MatrixXd states) {
    states.row(0) *= 1e9;
    return states;
  };
  const ComparedOrbit orbit = curve(clock, {in_units(nodes)});
  CHECK(orbit_distance(orbit, curve(clock, {in_units(ellipse(2.0, 1.001, 0.0))})) ==
        Approx(orbit_distance(curve(clock, {nodes}), curve(clock, {ellipse(2.0, 1.001, 0.0)}))).epsilon(1e-6));
}

TEST_CASE("a smooth orbit is the same curve wherever it begins") {
  const ComparedOrbit orbit = curve(smooth, {ellipse(2.0, 1.0, 0.0)});
  const auto other = [](double a, double shift, double by) { return curve(smooth, {ellipse(a, 1.0, shift, by)}); };
  CHECK(orbit_distance(orbit, other(2.0, 1.234, 0.0)) < 1e-5);
  CHECK(orbit_distance(orbit, other(2.0, 0.01, 0.0)) < 1e-5);
  CHECK(orbit_distance(orbit, other(2.001, 1.234, 0.0)) > 1e-4);
  CHECK(orbit_distance(orbit, other(2.0, 1.234, 5e-4)) > 1e-4);
}

TEST_CASE("an orbit that passes close to itself is the same curve, whichever passage has the nearest node") {
  // Eight turns of a spiral there and back, 0.002 apart, with nodes 0.08 apart.
  const auto spiral = [](double shift) {
    MatrixXd states(2, 641);
    for (int k = 0; k <= 640; ++k) {
      const double t = std::fmod(k / 640.0 + shift, 1.0), angle = 16.0 * std::acos(-1.0) * t;
      const double radius = 1.0 + 0.008 * std::cos(2.0 * std::acos(-1.0) * t);
      states.col(k) = Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
    }
    return states;
  };
  CHECK(orbit_distance(curve(smooth, {spiral(0.0)}), curve(smooth, {spiral(0.0123)})) < 1e-5);
}

TEST_CASE("orbits that pass the same places are two where their periods are no multiples of each other") {
  ComparedOrbit once = curve(smooth, {ellipse(2.0, 1.0, 0.0)}), other = once;
  once.period = 3.0;
  for (const double period : {3.0, 6.0, 6.0 * (1.0 + 1e-6), 1.5}) {
    other.period = period;
    CHECK(orbit_distance(once, other) < 1e-5);
  }
  other.period = 6.0 * (1.0 + 2e-5);
  CHECK(orbit_distance(once, other) == INFINITY);
}

TEST_CASE("orbits that are not cut alike and not known between their cuts cannot be compared") {
  CHECK(orbit_distance(cut_orbit(clock, MatrixXd{{1.0}}), cut_orbit(impact_first, MatrixXd{{1.0, 1.0}})) == INFINITY);
}

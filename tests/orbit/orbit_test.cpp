// Orbits, vectors of unknowns, and the inner product of pseudo-arclength.
#include <catch2/catch.hpp>

#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"
#include "support/sampled_orbit.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const std::vector<double> mesh{0.0, 0.3, 0.4, 1.0};

Orbit orbit_of(const std::function<Eigen::VectorXd(double)>& u) {
  return sampled_orbit({{1.0, u}, {1.0, u}}, 2, 3, 3, parameters({1.5, -2.0}), mesh);
}

}  // namespace

TEST_CASE("nodes of an orbit: places in tau and in the matrix of states") {
  const Orbit x = orbit_of([](double t) { return Eigen::Vector2d(t, -t); });
  CHECK(x.shape.nodes() == 10);
  CHECK(x.shape.columns() == 20);
  CHECK(x.tau(0) == 0.0);
  CHECK(x.tau(3) == 0.3);
  CHECK(x.tau(4) == Approx(0.3 + 0.1 / 3));
  CHECK(x.tau(9) == 1.0);
  CHECK(x.node_times().size() == 10);
  CHECK(x.start(1) == x.states.col(10).data());
  CHECK(x.end(1)[0] == 1.0);
  CHECK(x.period() == 2.0);
}

TEST_CASE("moving an orbit along a vector, and measuring the way back by a dual vector") {
  const Orbit base = orbit_of([](double t) { return Eigen::Vector2d(t, -t); });
  OrbitVector v(base.shape, 2);
  v.states.setConstant(0.5);
  v.durations << 1.0, -2.0;
  v.globals << 0.25, 3.0;
  Orbit x = base;
  advance(x, 0.1, v, {2, 1});
  CHECK(x.par(1) == Approx(-2.0 + 0.025));
  CHECK(x.par(0) == Approx(1.8));
  CHECK(x.duration(1) == Approx(0.8));
  CHECK(x.states(0, 0) == Approx(0.05));
  OrbitVector row(base.shape, 2);
  row.states(1, 7) = 2.0;
  row.durations(0) = 1.0;
  row.globals(1) = -1.0;
  CHECK(dot_difference(row, x, base, {2, 1}) == Approx(0.1 * dot(row, v)));
  CHECK(dot(row, v) == Approx(1.0 + 1.0 - 3.0));
}

TEST_CASE("the inner product integrates polynomials exactly, with the user's weights") {
  const Orbit x = orbit_of([](double t) { return Eigen::Vector2d(t, t * t); });
  ParameterVector weights{ParameterLayout()};
  weights.setOnes();
  weights(0) = 5.0;
  weights(ParameterLayout().first_duration()) = 0.0;  // PAR(62)
  const WeightedNorm norm(Eigen::Vector2d(2.0, 3.0), weights);
  OrbitVector v(x.shape, 1), row(x.shape, 1);
  v.states = x.states;
  v.durations << 0.5, 7.0;
  v.globals << 0.2;
  const double square = norm.dual(x, CollocationRule(3), {1}, v, row);
  CHECK(square == dot(row, v));  // to the last bit
  // Two segments of 2 / 3 + 3 / 5 each.
  CHECK(dot(row, v) == Approx(2 * (2.0 / 3 + 3.0 / 5) + 0.25 + 5 * 0.04).epsilon(1e-13));
  OrbitVector other(x.shape, 1);
  other.states.row(0).setOnes();  // <t, 1> = 1 / 2
  CHECK(dot(row, other) == Approx(2 * 2 * 0.5).epsilon(1e-13));
}

TEST_CASE("unit weights reach to the last of a thousand durations") {
  const OrbitShape shape{1, 1000, 1, 2};
  const Orbit x{shape, uniform_mesh(1), Eigen::MatrixXd::Zero(1, shape.columns()),
                ParameterVector(ParameterLayout(), shape.segments)};
  OrbitVector v(shape, 0), row(shape, 0);
  v.durations.setLinSpaced(1.0, 1000.0);
  CHECK(WeightedNorm::unit(shape).dual(x, CollocationRule(2), {}, v, row) == v.durations.squaredNorm());
  CHECK(row.durations == v.durations);
}

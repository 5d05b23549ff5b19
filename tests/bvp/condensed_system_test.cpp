// The condensed linearisation against finite differences of the residual and against the integrated flow.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "bvp/bordered_problem.hpp"
#include "bvp/condensed_system.hpp"
#include "bvp/periodic_orbit_system.hpp"
#include "directional_derivative.hpp"
#include "support/linear_oscillator.hpp"
#include "support/random_matrices.hpp"
#include "support/three_modes.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

double largest_difference(const OrbitVector& a, const OrbitVector& b) {
  return std::max({(a.states - b.states).cwiseAbs().maxCoeff(), (a.durations - b.durations).cwiseAbs().maxCoeff(),
                   (a.globals - b.globals).cwiseAbs().maxCoeff()});
}

/// An orbit that solves nothing: smooth states of size 1, uneven mesh.
Orbit any_orbit(const OrbitShape& shape, const ParameterVector& par) {
  Orbit x{shape, uniform_mesh(shape.intervals), Eigen::MatrixXd(shape.dimension, shape.columns()), par};
  for (std::size_t j = 1; j + 1 < x.mesh.size(); ++j) x.mesh[j] = std::pow(x.mesh[j], 1.3);
  for (Eigen::Index k = 0; k < x.states.cols(); ++k)
    for (Eigen::Index i = 0; i < x.states.rows(); ++i)
      x.states(i, k) = std::sin(0.3 + 0.9 * static_cast<double>(i) + 0.11 * static_cast<double>(k));
  for (int s = 0; s < shape.segments; ++s) x.duration(s) = 0.7 + 0.2 * s;
  return x;
}

struct Case {
  int intervals, collocation;
  std::vector<int> free_parameters;
};

}  // namespace

TEST_CASE("solving with the differences of the residual along a direction gives the direction back") {
  // N = 1 has no joins; two free parameters need two border rows; c = 6 has no compiled-in kernel.
  const Case c = GENERATE(Case{1, 3, {1}}, Case{2, 2, {2}}, Case{7, 4, {1}}, Case{5, 6, {2, 1}}, Case{3, 7, {1, 2}});
  CAPTURE(c.intervals, c.collocation, c.free_parameters.size());
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), c.free_parameters);
  const OrbitShape shape{3, 3, c.intervals, c.collocation};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  CondensedSystem condensed(system, shape, {static_cast<int>(c.free_parameters.size())});
  std::vector<OrbitVector> rows;
  std::vector<double> border;
  const OrbitVector v = random_vector(condensed, 1);
  for (unsigned b = 0; b < c.free_parameters.size(); ++b) {
    rows.push_back(random_vector(condensed, 10 + b));
    border.push_back(dot(rows.back(), v));
  }
  OrbitResidual residual = condensed.make_residual(), evaluated = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  condensed.evaluate(x, evaluated);
  CHECK(residual.collocation == evaluated.collocation);
  CHECK(residual.coupling == evaluated.coupling);

  OrbitResidual change = directional_derivative(condensed, x, v);
  negate(change);
  OrbitVector found = condensed.make_vector();
  condensed.solve(change, border, found);
  // Differences are accurate to 1e-10; the condition of these matrices is below 1e4.
  CHECK(largest_difference(found, v) < 1e-6);
}

TEST_CASE("solving with zero residual: the border's answer is linear in the border and annihilated by J") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1});
  const OrbitShape shape{3, 3, 6, 4};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  CondensedSystem condensed(system, shape, {1});
  const std::vector<OrbitVector> rows{random_vector(condensed, 3)};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  OrbitVector one = condensed.make_vector(), two = condensed.make_vector();
  condensed.solve(std::vector<double>{1.0}, one);
  condensed.solve(std::vector<double>{2.0}, two);
  CHECK(dot(rows[0], one) == Approx(1.0).epsilon(1e-9));
  one.scale(2.0);
  CHECK(largest_difference(one, two) < 1e-12 * two.states.cwiseAbs().maxCoeff());
  one.scale(0.5 / one.states.cwiseAbs().maxCoeff());
  CHECK(directional_derivative(condensed, x, one).largest() < 1e-9);
}

TEST_CASE("a correction and a tangent found at once are those found one by one") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1, 2});
  const OrbitShape shape{3, 3, GENERATE(1, 6, 9), 4};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  CondensedSystem condensed(system, shape, {2});
  const std::vector<OrbitVector> rows{random_vector(condensed, 3), random_vector(condensed, 5)};
  const std::vector<double> border{0.3, -0.7}, along{1.0, 0.0};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  OrbitVector dx = condensed.make_vector(), v = dx, dx_alone = dx, v_alone = dx;
  condensed.solve_both(residual, border, dx, v);
  condensed.solve(residual, border, dx_alone);
  condensed.solve(along, v_alone);
  CHECK(largest_difference(v, v_alone) == 0.0);
  // The residual of dx is eliminated along with the rows, or afterwards.
  CHECK(largest_difference(dx, dx_alone) < 1e-10 * dx.states.cwiseAbs().maxCoeff());
}

TEST_CASE("the determinant's sign follows the border and is comparable between neighbouring orbits") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1});
  const OrbitShape shape{3, 3, 6, 4};
  Orbit x = any_orbit(shape, ThreeModes::par());
  CondensedSystem condensed(system, shape, {1});
  std::vector<OrbitVector> rows{random_vector(condensed, 3)};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  const int sign = condensed.determinant().sign;
  CHECK(std::abs(sign) == 1);
  advance(x, 1e-6, random_vector(condensed, 4), system.free_parameters());
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  CHECK(condensed.determinant().sign == sign);
  rows[0].scale(-1.0);
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  CHECK(condensed.determinant().sign == -sign);
}

TEST_CASE("a closing row, at the ends of segments alone, is the general row that is zero elsewhere") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1, 2});
  const OrbitShape shape{3, 3, GENERATE(1, 6), 4};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  std::vector<OrbitVector> rows;
  CondensedSystem general(system, shape, {2, 0}), closing(system, shape, {1, 1});
  for (unsigned k = 0; k < 2; ++k) rows.push_back(random_vector(general, 3 + k));
  OrbitResidual residual = general.make_residual();
  REQUIRE(closing.linearize(x, rows, residual) == Linearization::ready);
  for (Eigen::Index k = 0; k < rows[0].states.cols(); ++k)
    if (k % shape.nodes() != 0 && k % shape.nodes() != shape.nodes() - 1) rows[0].states.col(k).setZero();
  REQUIRE(general.linearize(x, rows, residual) == Linearization::ready);
  const std::vector<double> border{0.3, -0.7};
  OrbitVector by_general = general.make_vector(), by_closing = by_general;
  general.solve(residual, border, by_general);
  closing.solve(residual, border, by_closing);
  const double size = by_general.states.cwiseAbs().maxCoeff();
  CHECK(largest_difference(by_closing, by_general) < 1e-10 * size);
  CHECK(general.determinant().sign == closing.determinant().sign);
  CHECK(general.determinant().log2_size == Approx(closing.determinant().log2_size).margin(1e-9));
}

TEST_CASE("what stands for a branch's row gives the corrections, tangents and signs that the row itself gives") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1});
  const OrbitShape shape{3, 3, GENERATE(1, 6), 4};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  BorderedProblem problem(system, shape, nullptr);
  CondensedSystem with_row(system, shape, {1});
  OrbitResidual residual = with_row.make_residual();
  OrbitVector dx = with_row.make_vector(), expected = dx, tangent = dx;
  int negative = 0, opposite = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::vector<OrbitVector> rows{random_vector(with_row, 100 + seed)};
    const bool inside = seed % 4 == 3;  // like the gradient of a monitor: nothing at the ends
    if (inside) {
      for (Eigen::Index k = 0; k < rows[0].states.cols(); ++k)
        if (k % shape.nodes() == 0 || k % shape.nodes() == shape.nodes() - 1) rows[0].states.col(k).setZero();
      rows[0].durations.setZero();
      rows[0].globals.setZero();
    }
    CAPTURE(shape.intervals, seed);
    REQUIRE(with_row.linearize(x, rows, residual) == Linearization::ready);
    REQUIRE(problem.linearize(x, rows[0], residual) == Linearization::ready);
    CHECK(problem.condensed().closing_row_gave_way() == inside);
    // Rounding times the condition of the matrices, below 1e5; a random row may be nearly orthogonal to the tangent.
    const double rounding = 1e-9;

    with_row.solve(residual, std::vector<double>{0.4}, expected);
    REQUIRE(problem.correct(residual, 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());
    REQUIRE(problem.solve(residual, 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    with_row.solve(std::vector<double>{1.0}, expected);
    problem.find_tangent(tangent);
    CHECK(dot(rows[0], tangent) > 0.0);
    REQUIRE(problem.solve(residual, 0.4, dx));  // after the tangent was taken
    CHECK(dot(rows[0], dx) == Approx(0.4).margin(1e-9));
    tangent.scale(1.0 / dot(rows[0], tangent));
    CHECK(largest_difference(tangent, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    const double distance = problem.signed_distance();
    CHECK((distance < 0.0) == (with_row.determinant().sign < 0));
    negative += distance < 0.0 ? 1 : 0;
    opposite += problem.condensed().determinant().sign != with_row.determinant().sign ? 1 : 0;
  }
  CHECK(negative > 5);
  CHECK(negative < 35);
  CHECK(opposite > 5);  // the sign has to be corrected for
}

TEST_CASE("segment blocks are the flow Jacobian: A + C Phi = 0") {
  const ParameterVector par = ThreeModes::par();
  const PeriodicOrbit reference = ThreeModes::orbit(par);
  REQUIRE(reference.converged);
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1});
  const Orbit x =
      sampled_orbit(pieces_of(system_of<ThreeModes>(), ThreeModes::signature(), reference.map, par), 3, 30, 4, par);
  CondensedSystem condensed(system, x.shape, {1});
  const std::vector<OrbitVector> rows{random_vector(condensed, 3)};
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, rows, residual) == Linearization::ready);
  using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  for (int s = 0; s < 3; ++s) {
    const Eigen::Matrix3d first = Block(condensed.first_block(s)), last = Block(condensed.last_block(s));
    Eigen::Matrix3d flow;
    for (int k = 0; k < 3; ++k) flow.col(k) = -solution(last, first.col(k));
    CHECK((flow - reference.map.segments[static_cast<std::size_t>(s)].flow_jacobian).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("a residual that is not finite is said to be so, and linearize refuses it") {
  const PeriodicOrbitSystem system(linosc(), {{1, 1, 1}}, {1});
  const OrbitShape shape{4, 1, 5, 4};
  Orbit x = any_orbit(shape, parameters({3.0, 2.0, 0.05, 0.8}));
  CondensedSystem condensed(system, shape, {1});
  const std::vector<OrbitVector> rows{random_vector(condensed, 3)};
  OrbitResidual residual = condensed.make_residual();
  x.states(2, 7) = NAN;
  condensed.evaluate(x, residual);
  CHECK_FALSE(residual.finite());
  CHECK(condensed.linearize(x, rows, residual) == Linearization::not_finite);
  x.states(2, 7) = 0.1;
  CHECK(condensed.linearize(x, rows, residual) == Linearization::ready);
  CHECK(residual.finite());
}

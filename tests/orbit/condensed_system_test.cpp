// The condensed linearisation against finite differences of the residual and against the integrated flow.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "directional_derivative.hpp"
#include "orbit/bordered_problem.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/monitor.hpp"
#include "orbit/periodic_orbit_system.hpp"
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

/// Makes a row zero but at the ends of segments; what is left.
EndVector keep_ends(OrbitVector& row, const OrbitShape& shape) {
  EndVector ends;
  for (int s = 0; s < shape.segments; ++s) {
    const int first = s * shape.nodes(), last = first + shape.nodes() - 1;
    row.states.middleCols(first + 1, last - first - 1).setZero();
    for (const int column : {first, last})
      for (int a = 0; a < shape.dimension; ++a) ends.push_back(row.states(a, column));
    ends.push_back(row.durations(s));
  }
  ends.insert(ends.end(), row.globals.begin(), row.globals.end());
  return ends;
}

/// And the other way round.
void drop_ends(OrbitVector& row, const OrbitShape& shape) {
  for (Eigen::Index k = 0; k < row.states.cols(); ++k)
    if (k % shape.nodes() == 0 || k % shape.nodes() == shape.nodes() - 1) row.states.col(k).setZero();
  row.durations.setZero();
  row.globals.setZero();
}

void add(double factor, const OrbitVector& from, OrbitVector& to) {
  to.states += factor * from.states;
  to.durations += factor * from.durations;
  to.globals += factor * from.globals;
}

/// Numbers with these values and gradients, whatever the orbit is.
class GivenCondition final : public OrbitCondition {
 public:
  GivenCondition(std::vector<double> values, std::vector<OrbitVector> gradients)
      : values_(std::move(values)), gradients_(std::move(gradients)) {}
  int count() const override { return static_cast<int>(values_.size()); }
  bool evaluate(CondensedSystem&, const Orbit&) override { return true; }
  double value(int k) const override { return values_[static_cast<std::size_t>(k)]; }
  const OrbitVector& gradient(int k) const override { return gradients_[static_cast<std::size_t>(k)]; }
  void remember(std::vector<double>& memory) const override { memory.clear(); }
  void recall(const std::vector<double>&) override {}

 private:
  std::vector<double> values_;
  std::vector<OrbitVector> gradients_;
};

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
  OrbitResidual of_ends = condensed.make_residual_of_ends();
  REQUIRE(condensed.linearize(x, rows, of_ends) == Linearization::ready);
  CHECK(of_ends.collocation.empty());
  CHECK(of_ends.coupling == evaluated.coupling);
  CHECK(of_ends.largest() == evaluated.largest());

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
  condensed.solve_with_null_vectors(residual, border, dx, std::span(&v, 1));
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
  const std::vector<EndVector> ends{keep_ends(rows[0], shape)};
  OrbitResidual residual = general.make_residual();
  REQUIRE(closing.linearize(x, ends, std::span(rows).last(1), residual) == Linearization::ready);
  CHECK_FALSE(closing.closing_rows_gave_way());
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

TEST_CASE("several closing rows are the ends of null vectors, which are orthonormal") {
  const PeriodicOrbitSystem system(system_of<ThreeModes>(), ThreeModes::signature(), {1, 2});
  const OrbitShape shape{3, 3, 6, 4};
  const Orbit x = any_orbit(shape, ThreeModes::par());
  CondensedSystem condensed(system, shape, {0, 2}), general(system, shape, {2, 0});
  std::vector<OrbitVector> rows{random_vector(condensed, 3), random_vector(condensed, 4)};
  OrbitResidual residual = condensed.make_residual(), of_general = residual;
  REQUIRE(condensed.linearize(x, {}, {}, residual) == Linearization::ready);
  CHECK(condensed.closing_rows_gave_way());
  REQUIRE(general.linearize(x, rows, of_general) == Linearization::ready);

  // In units of each parameter's 1 + |p|.
  OrbitVector z[2] = {condensed.make_vector(), condensed.make_vector()};
  std::vector<EndVector> of;
  for (int k = 0; k < 2; ++k) {
    condensed.null_vector(z[k], k);
    OrbitVector copy = z[k];
    for (int g = 0; g < 2; ++g) copy.globals(g) /= 1.0 + std::abs(x.par(g));
    of.push_back(keep_ends(copy, shape));
  }
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t l = 0; l < 2; ++l)
      CHECK(std::inner_product(of[k].begin(), of[k].end(), of[l].begin(), 0.0) == Approx(k == l).margin(1e-9));
  // A solution and the null vectors, by what the general rows say of them.
  OrbitVector y = condensed.make_vector(), expected = y;
  condensed.solve(residual, std::vector<double>{0.0, 0.0}, y);
  const std::vector<double> border{0.3, -0.7};
  general.solve(of_general, border, expected);
  Eigen::Matrix2d by_rows;
  Eigen::Vector2d rest;
  for (int r = 0; r < 2; ++r) {
    const OrbitVector& row = rows[static_cast<std::size_t>(r)];
    rest(r) = border[static_cast<std::size_t>(r)] - dot(row, y);
    for (int k = 0; k < 2; ++k) by_rows(r, k) = dot(row, z[k]);
  }
  const Eigen::Vector2d shares = by_rows.inverse() * rest;
  for (int k = 0; k < 2; ++k) add(shares(k), z[k], y);
  CHECK(largest_difference(y, expected) < 1e-9 * expected.states.cwiseAbs().maxCoeff());
  // Also the sign: that of the closing rows times that of the general rows on the null vectors.
  CHECK(general.determinant().sign == condensed.determinant().sign * (by_rows.determinant() > 0.0 ? 1 : -1));
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
    if (inside) drop_ends(rows[0], shape);
    CAPTURE(shape.intervals, seed);
    REQUIRE(with_row.linearize(x, rows, residual) == Linearization::ready);
    REQUIRE(problem.linearize(x, rows[0], residual) == Linearization::ready);
    CHECK(problem.condensed().closing_rows_gave_way() == inside);
    // Rounding times the condition of the matrices, below 1e5; a random row may be nearly orthogonal to the tangent.
    const double rounding = 1e-9;

    with_row.solve(residual, std::vector<double>{0.4}, expected);
    REQUIRE(problem.correct(residual, rows[0], 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());
    REQUIRE(problem.solve(residual, rows[0], 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    with_row.solve(std::vector<double>{1.0}, expected);
    tangent = problem.tangent();
    tangent.scale(problem.tangent_sign(rows[0]));
    CHECK(dot(rows[0], tangent) > 0.0);
    REQUIRE(problem.solve(residual, rows[0], 0.4, dx));  // after the tangent was taken
    CHECK(dot(rows[0], dx) == Approx(0.4).margin(1e-9));
    tangent.scale(1.0 / dot(rows[0], tangent));
    CHECK(largest_difference(tangent, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    const double distance = problem.signed_distance(rows[0]);
    CHECK((distance < 0.0 ? -1 : distance > 0.0) == with_row.determinant().sign);
    negative += distance < 0.0 ? 1 : 0;
    opposite += problem.condensed().determinant().sign != with_row.determinant().sign ? 1 : 0;
  }
  CHECK(negative > 5);
  CHECK(negative < 35);
  CHECK(opposite > 5);  // the sign has to be corrected for
}

TEST_CASE("what stands for a condition's gradients gives what they give themselves, beside a monitor that is held") {
  const int numbers = GENERATE(1, 2);
  const std::vector<int> free = numbers == 1 ? std::vector<int>{1, 3, 4} : std::vector<int>{1, 2, 3, 4};
  const PeriodicOrbitSystem system(linosc(), {{1, 1, 1}, {1, 1, 1}}, free);
  const OrbitShape shape{4, 2, GENERATE(1, 6), 4};
  const Orbit x = any_orbit(shape, parameters({3.0, 2.0, 0.05, 0.8}));
  const std::shared_ptr<const Monitor> monitor = make_monitor(parse_monitor(linosc(), "mean(x1)", "test"), system);
  CondensedSystem with_rows(system, shape, {2 + numbers});
  OrbitResidual of_rows = with_rows.make_residual();
  OrbitVector expected = with_rows.make_vector(), dx = expected, tangent = expected;
  std::vector<OrbitVector> rows(static_cast<std::size_t>(2 + numbers), expected);
  const double held = 0.3;
  const double off = monitor->gradient(x, with_rows.rule(), rows[1]) - held;
  int negative = 0, opposite = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    CAPTURE(numbers, shape.intervals, seed);
    rows[0] = random_vector(with_rows, 1000 + seed);
    std::vector<double> values, border{0.4, -off};
    for (int k = 0; k < numbers; ++k) {
      OrbitVector& gradient = rows[static_cast<std::size_t>(2 + k)];
      gradient = random_vector(with_rows, 10 * seed + static_cast<unsigned>(k));
      if (seed % 4 == 3) drop_ends(gradient, shape);
      values.push_back(0.2 - 0.5 * k);
      border.push_back(-values.back());
    }
    BorderedProblem problem(system, shape,
                            std::make_unique<GivenCondition>(values, std::vector(rows.begin() + 2, rows.end())),
                            {{monitor, held, "mean(x1)"}});
    OrbitResidual residual = problem.make_residual();
    REQUIRE(problem.linearize(x, rows[0], residual) == Linearization::ready);
    REQUIRE(with_rows.linearize(x, rows, of_rows) == Linearization::ready);
    // Rounding times the condition of the matrices, with rows that may nearly depend on one another where they meet.
    const double rounding = 1e-8;

    with_rows.solve(of_rows, border, expected);
    REQUIRE(problem.correct(residual, rows[0], 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());
    REQUIRE(problem.solve(residual, rows[0], 0.4, dx));
    CHECK(largest_difference(dx, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    with_rows.null_vector(expected);
    tangent = problem.tangent();
    tangent.scale(problem.tangent_sign(rows[0]));
    CHECK(dot(rows[0], tangent) > 0.0);
    tangent.scale(1.0 / dot(rows[0], tangent));
    CHECK(largest_difference(tangent, expected) < rounding * expected.states.cwiseAbs().maxCoeff());

    // Another order of the rows: the gradients were moved before the monitor's, which turns the sign for each of them.
    const int sign = with_rows.determinant().sign * (numbers % 2 == 0 ? 1 : -1);
    const double distance = problem.signed_distance(rows[0]);
    CHECK((distance < 0.0 ? -1 : distance > 0.0) == sign);
    CHECK(problem.singularity(rows[0]).reciprocal_condition > 1e-8);
    negative += sign < 0 ? 1 : 0;
    opposite += problem.condensed().determinant().sign != sign ? 1 : 0;
  }
  CHECK(negative > 5);
  CHECK(negative < 35);
  CHECK(opposite > 5);  // the sign has to be corrected for
}

TEST_CASE("the distance to a singular problem with a condition depends on no closing row, and passes zero linearly") {
  // grad G = what all vectors that the linearisation annihilates are blind to, and `share` of another row.
  const PeriodicOrbitSystem system(linosc(), {{1, 1, 1}, {1, 1, 1}}, {1, 3});
  const OrbitShape shape{4, 2, 6, 4};
  const Orbit x = any_orbit(shape, parameters({3.0, 2.0, 0.05, 0.8}));
  CondensedSystem condensed(system, shape, {0, 2});
  OrbitResidual residual = condensed.make_residual();
  REQUIRE(condensed.linearize(x, {}, {}, residual) == Linearization::ready);
  OrbitVector z[2] = {condensed.make_vector(), condensed.make_vector()};
  Eigen::Matrix2d products;
  for (int k = 0; k < 2; ++k) condensed.null_vector(z[k], k);
  for (int k = 0; k < 2; ++k)
    for (int l = 0; l < 2; ++l) products(k, l) = dot(z[k], z[l]);
  OrbitVector blind = random_vector(condensed, 60);
  const OrbitVector across = random_vector(condensed, 61);
  const Eigen::Vector2d seen = products.inverse() * Eigen::Vector2d(dot(blind, z[0]), dot(blind, z[1]));
  for (int k = 0; k < 2; ++k) add(-seen(k), z[k], blind);

  const auto problem_at = [&](double share, const OrbitVector& row, double unit = 1.0) {
    OrbitVector gradient = blind;
    add(share, across, gradient);
    gradient.scale(unit);
    auto problem = std::make_unique<BorderedProblem>(
        system, shape, std::make_unique<GivenCondition>(std::vector{0.2}, std::vector{gradient}));
    OrbitResidual of = problem->make_residual();
    CHECK(problem->linearize(x, row, of) == Linearization::ready);
    return problem;
  };
  const OrbitVector row = random_vector(condensed, 62), other_row = random_vector(condensed, 63);
  const double distance = problem_at(1e-3, row)->signed_distance(row);
  CHECK(std::abs(distance) > 1e-9);
  for (const double share : {1e-4, 1e-6, -1e-6, -1e-3})
    CHECK(problem_at(share, row)->signed_distance(row) == Approx(distance * share / 1e-3).epsilon(0.01));
  CHECK(problem_at(1e-3, row, 1e9)->signed_distance(row) == Approx(distance).epsilon(1e-9));
  CHECK(std::abs(problem_at(1e-3, other_row)->signed_distance(other_row)) == Approx(std::abs(distance)).epsilon(1e-9));

  // Where nothing but rounding is left it is refused, and the direction is a null vector that the row annihilates.
  const CondensedSystem::Singularity singularity = problem_at(0.0, row)->singularity(row);
  CHECK(singularity.reciprocal_condition < 1e-11);
  CHECK(std::abs(dot(row, singularity.direction)) < 1e-9);
  OrbitVector rest = singularity.direction;
  const Eigen::Vector2d parts = products.inverse() * Eigen::Vector2d(dot(rest, z[0]), dot(rest, z[1]));
  for (int k = 0; k < 2; ++k) add(-parts(k), z[k], rest);
  CHECK(rest.states.cwiseAbs().maxCoeff() < 1e-9 * singularity.direction.states.cwiseAbs().maxCoeff());
  CHECK(problem_at(1e-3, row)->singularity(row).reciprocal_condition > 1e-6);
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

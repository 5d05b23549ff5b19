// The elimination of a segment in lanes, for numbers of intervals that fill the lanes and that do not, against the
// dense matrix of its collocation rows.
#include "orbit/segment_elimination.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "support/random_matrices.hpp"
#include "support/three_modes.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int n = 3, segments = 2, border = 2, scalars = 3;
const std::vector<int> active = {1, 2};

Orbit random_orbit(std::mt19937& generator, const OrbitShape& shape) {
  Orbit x{shape, uniform_mesh(shape.intervals), random_matrix(generator, n, shape.columns()), ThreeModes::par()};
  for (std::size_t j = 1; j + 1 < x.mesh.size(); ++j) x.mesh[j] = std::pow(x.mesh[j], 1.3);
  for (int s = 0; s < segments; ++s) x.duration(s) = 0.7 + 0.2 * s;
  return x;
}

OrbitVector random_row(std::mt19937& generator, const OrbitShape& shape) {
  OrbitVector row(shape, scalars - 1);
  row.states = random_matrix(generator, n, shape.columns());
  return row;
}

/// The collocation rows of segment s: columns (nodes | duration | parameters), and the residual.
MatrixXd dense_rows(const HybridSystem& system, int field, const Orbit& x, int s, VectorXd& residual) {
  const CollocationRule rule(x.shape.collocation);
  const int c = x.shape.collocation, rows = x.shape.intervals * c * n, states = n * x.shape.nodes();
  MatrixXd dense = MatrixXd::Zero(rows, states + scalars);
  residual.resize(rows);
  for (int j = 0; j < x.shape.intervals; ++j) {
    const double h = x.mesh[static_cast<std::size_t>(j + 1)] - x.mesh[static_cast<std::size_t>(j)];
    const auto nodes = x.states.middleCols(s * x.shape.nodes() + j * c, c + 1);
    for (int g = 0; g < c; ++g) {
      const VectorXd point = nodes * rule.value.row(g).transpose();
      VectorXd f(n);
      MatrixXd fx(n, n), fp(n, scalars - 1);
      system.first(FunctionKind::field, field, point.data(), x.par.data(), active, f.data(), fx.data(), fp.data());
      const int row = (j * c + g) * n;
      for (int i = 0; i <= c; ++i)
        dense.block(row, (j * c + i) * n, n, n) +=
            rule.slope(g, i) * MatrixXd::Identity(n, n) - h * x.duration(s) * rule.value(g, i) * fx;
      dense.block(row, states, n, 1) = -h * f;
      dense.block(row, states + 1, n, scalars - 1) = -h * x.duration(s) * fp;
      residual.segment(row, n) = nodes * rule.slope.row(g).transpose() - h * x.duration(s) * f;
    }
  }
  return dense;
}

/// All unknowns of segment s in the order of dense_rows.
VectorXd unknowns(const OrbitVector& v, const OrbitShape& shape, int s) {
  const MatrixXd states = v.states.middleCols(s * shape.nodes(), shape.nodes());
  VectorXd all(states.size() + scalars);
  all << states.reshaped(), v.durations(s), v.globals;
  return all;
}

struct Sizes {
  int intervals, collocation;
};

}  // namespace

TEST_CASE("every interval of a segment is in one lane, lanes are as long as one another or one shorter") {
  for (int intervals = 1; intervals < 70; ++intervals) {
    const LaneSchedule schedule(intervals);
    std::vector<int> seen;
    for (int l = 0; l < lanes; ++l)
      for (int group = 0; group < schedule.groups(); ++group) {
        if (schedule.holds(group, l)) seen.push_back(schedule.interval(group, l));
        CHECK(schedule.interval(group, l) < intervals);
        CHECK((schedule.holds(group, l) || group + 1 == schedule.groups()));
      }
    std::vector<int> all(static_cast<std::size_t>(intervals));
    std::iota(all.begin(), all.end(), 0);
    CHECK(seen == all);
    CHECK(schedule.size(lanes - 1) == schedule.groups());
  }
}

TEST_CASE("a segment condensed in lanes against the dense matrix of its collocation rows") {
  const Sizes sizes = GENERATE(Sizes{1, 3}, Sizes{2, 4}, Sizes{3, 2}, Sizes{4, 3}, Sizes{5, 4}, Sizes{6, 2},
                               Sizes{7, 3}, Sizes{8, 3}, Sizes{9, 2}, Sizes{11, 5}, Sizes{13, 2}, Sizes{50, 2});
  CAPTURE(sizes.intervals, sizes.collocation);
  const HybridSystem system = system_of<ThreeModes>();
  const OrbitShape shape{n, segments, sizes.intervals, sizes.collocation};
  SegmentElimination elimination(shape, scalars, border, CollocationRule(sizes.collocation));
  std::mt19937 generator(4);
  std::vector<int> relative_signs;
  for (int trial = 0; trial < 4; ++trial) {
    const Orbit x = random_orbit(generator, shape);
    const std::vector<OrbitVector> rows = {random_row(generator, shape), random_row(generator, shape)};
    LargeProduct expected;
    int relative_sign = 1;
    for (int s = 0; s < segments; ++s) {
      VectorXd residual;
      const MatrixXd dense = dense_rows(system, s + 1, x, s, residual);
      VectorXd found_residual(residual.size());
      REQUIRE(elimination.condense(s, system, s + 1, active, x, rows, found_residual.data()) == Linearization::ready);
      CHECK((found_residual - residual).norm() < 1e-13 * (1.0 + residual.norm()));

      // What is left, closed by conditions on (first node | last node | T, p): solved by Eigen whole, and in steps.
      const int length = 2 * n + scalars;
      REQUIRE(elimination.length() == length + 1);
      using Rows = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>;
      const MatrixXd left = Rows(elimination.rows(s), n, length + 1).leftCols(length);
      const VectorXd left_residual = Rows(elimination.rows(s), n, length + 1).col(length);
      const MatrixXd left_border = Rows(elimination.border(s), border, length + 1).leftCols(length);
      const VectorXd left_border_residual = Rows(elimination.border(s), border, length + 1).col(length);
      const MatrixXd closing = random_matrix(generator, length - n, length);
      const VectorXd wanted = random_matrix(generator, length - n, 1);
      const Eigen::Index all = dense.cols();
      MatrixXd whole = MatrixXd::Zero(all, all);
      whole.topRows(dense.rows()) = dense;
      whole.bottomLeftCorner(length - n, n) = closing.leftCols(n);
      whole.bottomRightCorner(length - n, n + scalars) = closing.rightCols(n + scalars);
      VectorXd right(all);
      right << -residual, wanted;
      const VectorXd by_eigen = whole.partialPivLu().solve(right);

      VectorXd condensed(n + border);
      elimination.condense_right_hand_side(s, residual.data(), condensed.data());
      // The residual that was eliminated along with the rows, and the one that was condensed afterwards.
      CHECK((left_residual + condensed.head(n)).norm() < 1e-11 * condensed.norm());
      CHECK((left_border_residual + condensed.tail(border)).norm() < 1e-11 * condensed.norm());
      MatrixXd reduced(length, length);
      reduced << left, closing;
      VectorXd reduced_right(length);
      reduced_right << condensed.head(n), wanted;
      const VectorXd ends = reduced.partialPivLu().solve(reduced_right);
      OrbitVector dx(shape, scalars - 1);
      dx.globals = ends.tail(scalars - 1);
      elimination.expand(s, {RightHandSide::condensed, ends.data(), dx.globals.data(), &dx});
      const VectorXd found = unknowns(dx, shape, s);
      OrbitVector own = dx;
      elimination.expand(s, {RightHandSide::own, ends.data(), dx.globals.data(), &own});
      CHECK((unknowns(own, shape, s) - found).norm() < 1e-11 * found.norm());
      // Random orbits and conditions: both solutions lose up to five digits.
      CHECK((found - by_eigen).norm() < 1e-8 * by_eigen.norm());
      CHECK((dense * found + residual).norm() < 1e-11 * (dense.norm() * found.norm()));
      for (int b = 0; b < border; ++b) {
        const auto k = static_cast<std::size_t>(b);
        const double value = rows[k]
                                 .states.middleCols(s * shape.nodes(), shape.nodes())
                                 .cwiseProduct(dx.states.middleCols(s * shape.nodes(), shape.nodes()))
                                 .sum();
        CHECK(std::abs(left_border.row(b).dot(ends) - condensed(n + b) - value) <
              1e-10 * (1.0 + left_border.row(b).norm() * ends.norm()));
      }

      // Homogeneous, and the adjoint.
      elimination.expand(s, {RightHandSide::zero, ends.data(), dx.globals.data(), &dx});
      const VectorXd homogeneous = unknowns(dx, shape, s);
      for (const int together : {2, 3, 4}) {
        std::vector<OrbitVector> again(static_cast<std::size_t>(together), dx);
        std::vector<SegmentSolution> solutions;
        for (OrbitVector& solution : again)
          solutions.push_back({&solution == &again[1] ? RightHandSide::zero : RightHandSide::own, ends.data(),
                               dx.globals.data(), &solution});
        elimination.expand_together(s, solutions);
        for (const OrbitVector& solution : again)
          CHECK(unknowns(solution, shape, s) == (&solution == &again[1] ? homogeneous : unknowns(own, shape, s)));
      }
      const VectorXd of_ends = left * ends;
      const VectorXd weights = random_matrix(generator, n, 1);
      VectorXd adjoint(residual.size());
      elimination.expand_adjoint(s, weights.data(), adjoint.data());
      CHECK(std::abs(adjoint.dot(dense * homogeneous) - weights.dot(of_ends)) <
            1e-10 * adjoint.norm() * dense.norm() * homogeneous.norm());
      VectorXd again(n + border);
      elimination.condense_right_hand_side(s, residual.data(), again.data());
      CHECK(again == condensed);
      CHECK(std::abs(weights.dot(condensed.head(n)) + adjoint.dot(residual)) <
            1e-11 * adjoint.norm() * residual.norm());

      // det(whole) = det(eliminated) det(reduced), but for the order of columns.
      const Eigen::PartialPivLU<MatrixXd> whole_lu(whole), reduced_lu(reduced);
      for (Eigen::Index k = 0; k < all; ++k) expected.multiply(whole_lu.matrixLU()(k, k));
      for (Eigen::Index k = 0; k < length; ++k) expected.multiply(1.0 / reduced_lu.matrixLU()(k, k));
      relative_sign *=
          static_cast<int>(whole_lu.permutationP().determinant() * reduced_lu.permutationP().determinant());
    }
    LargeProduct reciprocal;
    elimination.divide_by_determinant(reciprocal);
    CHECK(elimination.determinant_sign() == (reciprocal.mantissa > 0.0 ? 1 : -1));
    LargeProduct one = expected;
    one.multiply(reciprocal.mantissa);
    one.exponent += reciprocal.exponent;
    CHECK(std::abs(std::ldexp(std::abs(one.mantissa), static_cast<int>(one.exponent)) - 1.0) < 1e-9);
    relative_signs.push_back(one.mantissa > 0.0 ? relative_sign : -relative_sign);
  }
  for (const int sign : relative_signs) CHECK(sign == relative_signs.front());
}

TEST_CASE("one interval that cannot be evaluated or is singular is told, whichever it is") {
  const HybridSystem system = system_of<ThreeModes>();
  const OrbitShape shape{n, segments, 7, 3};
  SegmentElimination elimination(shape, scalars, border, CollocationRule(3));
  std::mt19937 generator(4);
  const Orbit x = random_orbit(generator, shape);
  const std::vector<OrbitVector> rows = {random_row(generator, shape), random_row(generator, shape)};
  VectorXd residual(shape.intervals * shape.collocation * n);
  for (int j = 0; j < shape.intervals; ++j) {
    Orbit broken = x;
    broken.node(0, j * 3 + 1)[1] = NAN;
    CHECK(elimination.condense(0, system, 1, active, broken, rows, residual.data()) == Linearization::not_finite);
  }
  CHECK(elimination.condense(0, system, 1, active, x, rows, residual.data()) == Linearization::ready);
}

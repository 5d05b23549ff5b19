// Small dense matrices by LAPACK, against Eigen's own decompositions and against what defines each result.
#include "linear/dense_matrix.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double rounding = 1e-12;  // of well-conditioned matrices with entries of size 1

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(generator); });
}

}  // namespace

TEST_CASE("eigenvalues: real ones and pairs, of any size, not a number for what is not finite", "[dense_matrix]") {
  for (const int n : {0, 1, 2, 3, 8}) {
    const MatrixXd a = random_matrix(n, n, 7u + static_cast<unsigned>(n));
    const Eigen::VectorXcd found = eigenvalues(a);
    REQUIRE(found.size() == n);
    for (const auto& mu : found) {
      const Eigen::MatrixXcd shifted = a.cast<std::complex<double>>() - mu * MatrixXd::Identity(n, n);
      CHECK(least_singular_value(shifted) < rounding);
    }
    if (n > 0) CHECK(std::abs(found.sum() - a.trace()) < rounding);
  }
  CHECK_FALSE(eigenvalues(MatrixXd::Constant(2, 2, std::nan(""))).allFinite());
}

TEST_CASE("linear systems: pivoted, completely pivoted, least squares", "[dense_matrix]") {
  for (const int n : {1, 2, 5, 9}) {
    const MatrixXd a = random_matrix(n, n, 30u + static_cast<unsigned>(n));
    const MatrixXd right = random_matrix(n, 3, 50u);
    const MatrixXd expected = a.fullPivLu().solve(right);
    CHECK((solve(a, right) - expected).norm() < 1e3 * rounding);
    CHECK((solve_with_complete_pivoting(a, right) - expected).norm() < 1e3 * rounding);
    CHECK((least_squares(a, right) - expected).norm() < 1e3 * rounding);
    const PivotedLu lu(a);
    CHECK(lu.parity() * lu.pivots().prod() == Approx(a.determinant()).epsilon(1e-10));
  }
  const MatrixXd tall = random_matrix(7, 2, 3u);
  const MatrixXd wanted = random_matrix(7, 2, 4u);
  const MatrixXd x = least_squares(tall, wanted);
  CHECK((tall.transpose() * (tall * x - wanted)).norm() < rounding);
}

TEST_CASE("singular systems: finite, and a solution where there is one", "[dense_matrix]") {
  MatrixXd a = random_matrix(4, 4, 9u);
  a.row(3) = a.row(0) + 2.0 * a.row(1);
  const VectorXd x = random_matrix(4, 1, 10u);
  const VectorXd right = a * x;
  for (const MatrixXd& found : {solve_with_complete_pivoting(a, right), least_squares(a, right)}) {
    CHECK(found.allFinite());
    CHECK((a * found - right).norm() < 100 * rounding);
  }
  CHECK(solve_with_complete_pivoting(MatrixXd::Zero(3, 3), VectorXd::Ones(3)).isZero(0.0));
  CHECK_FALSE(solve(MatrixXd::Zero(2, 2), VectorXd::Ones(2)).allFinite());
}

TEST_CASE("an unknown that nothing concerns stays exactly zero", "[dense_matrix]") {
  MatrixXd a = random_matrix(4, 4, 12u);
  a.row(2).setZero();
  a.col(2).setZero();
  a(2, 2) = 3.0;
  VectorXd right = random_matrix(4, 1, 13u);
  right(2) = 0.0;
  CHECK(solve_with_complete_pivoting(a, right)(2) == 0.0);
}

TEST_CASE("a reflection takes a vector to a multiple of the first unit vector, of any size", "[dense_matrix]") {
  for (const double size : {1.0, 1e-200, 1e200})
    for (const int n : {1, 2, 5}) {
      CAPTURE(size, n);
      const VectorXd x = random_matrix(n, 1, 60u + static_cast<unsigned>(n));
      VectorXd w = size * x;
      const double image = make_reflection(w);
      CHECK(w.squaredNorm() == Approx(2.0));
      CHECK(std::abs(image) == Approx(size * x.norm()));
      CHECK(image * x(0) < 0.0);
      MatrixXd reflected = x;
      reflect(w, reflected);
      CHECK((size * reflected / image - VectorXd::Unit(n, 0)).norm() < rounding);
      const MatrixXd matrix = random_matrix(n, n, 70u);
      MatrixXd from_the_right = matrix;
      reflect(w, from_the_right.transpose());
      CHECK((from_the_right - matrix * (MatrixXd::Identity(n, n) - w * w.transpose())).norm() < rounding);
    }
  VectorXd nothing = VectorXd::Zero(3);
  CHECK(make_reflection(nothing) == 0.0);
  CHECK(nothing.isZero(0.0));
}

TEST_CASE("triangular form by reflections: orthogonal, their determinant, the upper triangle", "[dense_matrix]") {
  for (const int columns : {1, 3, 6}) {
    CAPTURE(columns);
    MatrixXd a = random_matrix(6, columns, 20u);
    if (columns == 3) a.col(1).setZero();  // nothing to reflect in the second step
    MatrixXd both(6, columns + 6);
    both << a, MatrixXd::Identity(6, 6);
    const int parity = triangularise(both, columns);
    const MatrixXd q_transposed = both.rightCols(6);
    CHECK((q_transposed * q_transposed.transpose() - MatrixXd::Identity(6, 6)).norm() < rounding);
    CHECK(parity == Approx(q_transposed.determinant()));
    CHECK((q_transposed * a - both.leftCols(columns)).norm() < rounding);
    CHECK(both.leftCols(columns).triangularView<Eigen::StrictlyLower>().toDenseMatrix().isZero(0.0));
  }
}

TEST_CASE("the distance to a null space does not depend on the sizes of rows", "[dense_matrix]") {
  MatrixXd columns(4, 3);  // two rows, and x
  columns.transpose() << 3.0, 0.0, 0.0, 0.0, 0.0, 3e-180, 0.0, 4e-180, 0.3, 0.4, 5.0, 6.0;
  CHECK(distance_to_null_space(columns) == Approx(std::hypot(0.3, 0.6 * 0.4 + 0.8 * 6.0)).epsilon(1e-14));
}

// Dense factors of small matrices against Eigen's with complete pivoting, in long double.
#include "linear/partial_lu.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/random_matrices.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

namespace {

void fill(SmallLu& lu, const MatrixXd& a) {
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) lu.entries()[i * a.cols() + j] = a(i, j);
}

/// Rows of very different sizes, and zeros where the first pivots would be.
MatrixXd badly_scaled(std::mt19937& generator, int n) {
  MatrixXd a = test::random_matrix(generator, n, n);
  for (int i = 0; i < n; ++i) a.row(i) *= std::pow(10.0, (7 * i) % 13 - 6);
  for (int i = 0; i + 1 < n; ++i) a(i, i) = 0.0;
  return a;
}

}  // namespace

TEST_CASE("solutions and determinants of small matrices, transposed too") {
  std::mt19937 generator(2);
  for (const int n : {1, 2, 3, 4, 5, 9, 10, 19, 37, 64}) {
    SmallLu lu(n);
    for (int turn = 0; turn < 4; ++turn) {
      CAPTURE(n, turn);
      const MatrixXd a = turn < 2 ? test::random_matrix(generator, n, n) : badly_scaled(generator, n);
      const VectorXd b = test::random_matrix(generator, n, 1);
      const Eigen::FullPivLU<LongMatrix> exact(a.cast<long double>());
      fill(lu, a);
      REQUIRE(lu.factorize());
      VectorXd x(n);
      lu.solve(b.data(), x.data());
      const LongVector expected = exact.solve(b.cast<long double>());
      // Rows of any size are as good as rows of unit sum, whose condition counts.
      MatrixXd scaled = a;
      for (int i = 0; i < n; ++i) scaled.row(i) /= a.row(i).cwiseAbs().sum();
      const double tolerance = 1e-14 * test::condition_number(scaled);
      CHECK(static_cast<double>((x.cast<long double>() - expected).norm()) <
            tolerance * (1e-6 + static_cast<double>(expected.norm())));
      VectorXd y(n);
      lu.solve_transposed(b.data(), y.data());
      // Backward stable in the scaled unknowns.
      VectorXd scaled_y = y;
      for (int i = 0; i < n; ++i) scaled_y(i) *= a.row(i).cwiseAbs().sum();
      const LongVector rest =
          scaled.transpose().cast<long double>() * scaled_y.cast<long double>() - b.cast<long double>();
      CHECK(static_cast<double>(rest.norm()) < 1e-13 * (1.0 + n * scaled_y.norm()));

      long double determinant = lu.parity();
      for (int k = 0; k < n; ++k)
        determinant *= static_cast<long double>(lu.pivot(k)) * static_cast<long double>(lu.row_sum(k));
      const long double wanted = exact.determinant();
      CHECK(static_cast<double>(std::abs(determinant / wanted - 1.0L)) < 10 * tolerance);
    }
  }
}

TEST_CASE("solutions of small matrices with entries of all sizes: each equation holds to rounding of its own terms") {
  constexpr int n = 10;
  const auto largest_rest = [](const MatrixXd& a, const VectorXd& x, const VectorXd& b) {
    const LongVector rest = a.cast<long double>() * x.cast<long double>() - b.cast<long double>();
    const VectorXd terms = a.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
    return (rest.cast<double>().cwiseAbs().array() / terms.array()).maxCoeff();
  };
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> decades(-7.0, 0.0);
  SmallLu lu(n);
  for (int turn = 0; turn < 200; ++turn) {
    CAPTURE(turn);
    MatrixXd a = test::random_matrix(generator, n, n);
    for (double& entry : a.reshaped()) entry *= std::pow(10.0, decades(generator));
    const VectorXd b = test::random_matrix(generator, n, 1);
    fill(lu, a);
    REQUIRE(lu.factorize());
    VectorXd x(n), y(n);
    lu.solve(b.data(), x.data());
    lu.solve_transposed(b.data(), y.data());
    CHECK(largest_rest(a, x, b) < 1e-14);
    CHECK(largest_rest(a.transpose(), y, b) < 1e-14);
  }
}

TEST_CASE("small matrices that are singular or not finite are refused, and the next one is not") {
  SmallLu lu(4);
  std::mt19937 generator(5);
  const MatrixXd good = test::random_matrix(generator, 4, 4);
  MatrixXd zero_row = good, zero_column = good, equal_rows = good, not_a_number = good, infinite = good, huge = good;
  zero_row.row(2).setZero();
  zero_column.col(1).setZero();
  equal_rows << 1.0, 2.0, 4.0, 1.0, 1.0, 2.0, 4.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0;
  not_a_number(3, 0) = NAN;
  infinite(0, 3) = INFINITY;
  huge.row(1).setConstant(1.7e308);
  for (const MatrixXd& a : {zero_row, zero_column, equal_rows, not_a_number, infinite, huge}) {
    fill(lu, a);
    CHECK_FALSE(lu.factorize());
    fill(lu, good);
    CHECK(lu.factorize());
  }
}

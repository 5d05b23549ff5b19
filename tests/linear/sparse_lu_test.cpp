// The sparse solver against dense linear algebra.
#include <catch2/catch.hpp>
#include <random>

#include "linear/dense_matrix.hpp"
#include "linear/sparse_lu.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A random pattern with a full diagonal, some positions twice, and the dense matrix it stands for.
struct Sparse {
  int size;
  std::vector<int> rows, columns;
  std::vector<double> values;

  explicit Sparse(int n, unsigned seed = 1) : size(n) {
    std::mt19937 generator(seed);
    std::uniform_int_distribution<int> position(0, n - 1);
    std::normal_distribution<double> normal;
    const auto add = [&](int row, int column) {
      rows.push_back(row), columns.push_back(column), values.push_back(normal(generator));
    };
    for (int i = 0; i < n; ++i) add(i, i);
    for (int k = 0; k < 4 * n; ++k) add(position(generator), position(generator));
    for (int k = 0; k < n; k += 3) add(k, k);
  }
  explicit Sparse(const MatrixXd& full) : size(static_cast<int>(full.rows())) {
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) rows.push_back(i), columns.push_back(j), values.push_back(full(i, j));
  }
  MatrixXd dense() const {
    MatrixXd a = MatrixXd::Zero(size, size);
    for (std::size_t k = 0; k < rows.size(); ++k) a(rows[k], columns[k]) += values[k];
    return a;
  }
};

MatrixXd orthogonal(int n, unsigned seed) {
  std::mt19937 generator(seed);
  return test::random_orthogonal(generator, n);
}

}  // namespace

TEST_CASE("solutions with the matrix and its transpose, for several matrices of one pattern") {
  for (const int n : {1, 2, 7, 60}) {
    Sparse a(n);
    SparseLu lu(n, a.rows, a.columns);
    CHECK(lu.size() == n);
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    for (int turn = 0; turn < 3; ++turn) {
      CAPTURE(n, turn);
      REQUIRE(lu.factorize(a.values));
      const VectorXd x = VectorXd::NullaryExpr(n, [&] { return normal(generator); });
      const double condition = test::condition_number(a.dense());
      VectorXd b = a.dense() * x, found(n);
      lu.solve(b.data(), found.data());
      CHECK((found - x).norm() < 1e-14 * condition * (1 + x.norm()));
      b = a.dense().transpose() * x;
      lu.solve_transposed(b.data(), found.data());
      CHECK((found - x).norm() < 1e-14 * condition * (1 + x.norm()));
      const double determinant = test::determinant(a.dense());
      CHECK(lu.determinant().sign == (determinant > 0 ? 1 : -1));
      CHECK(lu.determinant().log2_size == Approx(std::log2(std::abs(determinant))).margin(1e-10));
      for (double& value : a.values) value = normal(generator);
    }
  }
}

TEST_CASE("singular matrices and values that are not finite") {
  Sparse a(6);
  SparseLu lu(6, a.rows, a.columns);
  const std::vector<double> good = a.values;
  for (std::size_t k = 0; k < a.rows.size(); ++k)
    if (a.rows[k] == 2) a.values[k] = 0.0;
  CHECK_FALSE(lu.factorize(a.values));
  a.values = good;
  a.values[4] = NAN;
  CHECK_FALSE(lu.factorize(a.values));
  CHECK(lu.determinant().sign == 0);
  CHECK(lu.factorize(good));
  CHECK_THROWS_AS(SparseLu(2, {0, 2}, {0, 1}), std::invalid_argument);
  CHECK_FALSE(SparseLu(2, {0, 0}, {0, 1}).factorize({1.0, 1.0}));  // row 1 has no entry
}

TEST_CASE("entries at the end of the range of double precision") {
  // Products of such entries overflow, the determinant does not.
  MatrixXd a = VectorXd::LinSpaced(6, 2.0, 7.0).asDiagonal();
  a(1, 1) = a(4, 4) = -1.7e308;
  a(0, 1) = a(3, 5) = 0.5;
  const Sparse sparse(a);
  SparseLu lu(6, sparse.rows, sparse.columns);
  REQUIRE(lu.factorize(sparse.values));
  CHECK(lu.determinant().sign == 1);
  CHECK(lu.determinant().log2_size == Approx(std::log2(2.0 * 4.0 * 5.0 * 7.0) + 2.0 * std::log2(1.7e308)));

  // Row sums that overflow: refused, or factors that are finite.
  for (const double huge : {1e200, 1.7e308}) {
    MatrixXd b(3, 3);
    b << 1.0, huge, huge, 1.0, -huge, huge, huge, huge, -huge;
    const Sparse full(b);
    SparseLu of_full(3, full.rows, full.columns);
    const int sign = of_full.factorize(full.values) ? 1 : 0;
    CHECK(std::abs(of_full.determinant().sign) == sign);
  }
}

TEST_CASE("a determinant far beyond the range of double precision") {
  Sparse a(40);
  MatrixXd scaled = a.dense();
  const double before = std::log2(std::abs(test::determinant(scaled)));
  const int sign = test::determinant(scaled) > 0 ? 1 : -1;
  const Sparse large(scaled * 1e100);
  SparseLu lu(40, large.rows, large.columns);
  REQUIRE(lu.factorize(large.values));
  CHECK(lu.determinant().sign == sign);
  CHECK(lu.determinant().log2_size == Approx(before + 4000 * std::log2(10.0)).margin(1e-6));
}

TEST_CASE("condition and null direction against the singular value decomposition") {
  const int n = 12;
  for (const double smallest : {1e-1, 1e-4, 1e-8, 1e-13}) {
    CAPTURE(smallest);
    VectorXd singular_values = VectorXd::Ones(n);
    singular_values(n - 1) = smallest;
    const MatrixXd right = orthogonal(n, 2);
    const MatrixXd a = orthogonal(n, 1) * singular_values.asDiagonal() * right.transpose();
    // Rows and columns scaled far apart: the condition is that of the matrix scaled back.
    VectorXd rows(n), columns(n);
    for (int i = 0; i < n; ++i) rows(i) = std::pow(10.0, i % 5 - 2), columns(i) = std::pow(10.0, (3 * i) % 7 - 3);
    const Sparse sparse(rows.asDiagonal() * a * columns.asDiagonal());
    SparseLu lu(n, sparse.rows, sparse.columns);
    lu.factorize(sparse.values);
    const SparseLu::Condition condition = lu.condition();
    // Scaling to unit largest entries changes the norms of an orthogonal matrix by at most sqrt(n) either way.
    CHECK(condition.reciprocal < n * smallest);
    CHECK(condition.reciprocal > smallest / n);
    if (smallest > 1e-3) continue;
    const VectorXd expected = columns.cwiseInverse().cwiseProduct(right.col(n - 1)).normalized();
    const VectorXd found = Eigen::Map<const VectorXd>(condition.null_direction.data(), n).normalized();
    CHECK(std::abs(found.dot(expected)) > 1 - 1e-3);
  }
}

TEST_CASE("the null direction of an exactly singular matrix") {
  MatrixXd a = orthogonal(8, 4);
  a.col(5).setZero();
  Sparse sparse(a);
  SparseLu lu(8, sparse.rows, sparse.columns);
  lu.factorize(sparse.values);
  const SparseLu::Condition condition = lu.condition();
  CHECK(condition.reciprocal < 1e-12);
  REQUIRE(condition.null_direction.size() == 8);
  const VectorXd found = Eigen::Map<const VectorXd>(condition.null_direction.data(), 8).normalized();
  CHECK(std::abs(found(5)) > 0.999);
}

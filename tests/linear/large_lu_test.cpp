// The LU of large matrices against dense linear algebra: what stands alone, and what no other unknown depends on.
#include "linear/large_lu.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "support/random_matrices.hpp"

using namespace tchat;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Unknowns of several kinds in random order: `own` of each of `kinds` have entries in as many rows alone.
RowMajor matrix_with_kinds(int others, int kinds, int own, std::mt19937& generator) {
  std::normal_distribution<double> normal;
  const int size = others + kinds * own;
  RowMajor ordered = RowMajor::NullaryExpr(size, size, [&] { return normal(generator); });
  for (int kind = 0; kind < kinds; ++kind) {
    const int first = others + kind * own;
    for (int i = 0; i < size; ++i)
      if (i < first || i >= first + own) ordered.row(i).segment(first, own).setZero();
  }
  std::vector<int> rows(static_cast<std::size_t>(size)), columns(rows.size());
  for (int k = 0; k < size; ++k) rows[static_cast<std::size_t>(k)] = columns[static_cast<std::size_t>(k)] = k;
  std::shuffle(rows.begin(), rows.end(), generator);
  std::shuffle(columns.begin(), columns.end(), generator);
  return ordered(rows, columns);
}

void judge(LargeLu& lu, const RowMajor& a, std::mt19937& generator) {
  std::normal_distribution<double> normal;
  const VectorXd x = VectorXd::NullaryExpr(a.rows(), [&] { return normal(generator); });
  const double rounding = 1e-13 * test::condition_number(a);
  VectorXd b = a * x;
  lu.solve(b.data());
  CHECK((b - x).norm() < rounding * x.norm());
  b = a.transpose() * x;
  lu.solve_transposed(b.data());
  CHECK((b - x).norm() < rounding * x.norm());
  const auto [sign, log2_size] = lu.determinant();
  const auto [expected, expected_log2_size] = test::sign_and_log2_of_determinant(a);
  CHECK(sign == expected);
  CHECK(log2_size == Approx(expected_log2_size).margin(1e-9));
}

}  // namespace

TEST_CASE("large LU: solutions, transposed ones and determinants, whatever unknowns stand alone") {
  std::mt19937 generator(2);
  for (const auto& [others, kinds, own] : {std::array{40, 0, 0}, {30, 1, 9}, {12, 3, 5}, {0, 2, 6}, {1, 1, 1}}) {
    CAPTURE(others, kinds, own);
    LargeLu lu(others + kinds * own);
    for (int k = 0; k < 6; ++k) {
      const RowMajor a = matrix_with_kinds(others, kinds, own, generator);
      REQUIRE(lu.factorize(a.data()));
      judge(lu, a, generator);
    }
    // The same object for a matrix without such unknowns.
    const RowMajor full = matrix_with_kinds(others + kinds * own, 0, 0, generator);
    REQUIRE(lu.factorize(full.data()));
    judge(lu, full, generator);
  }
}

TEST_CASE("large LU: what is singular or not finite is refused") {
  std::mt19937 generator(3);
  RowMajor a = matrix_with_kinds(10, 1, 4, generator);
  LargeLu lu(14);
  REQUIRE(lu.factorize(a.data()));
  RowMajor bad = a;
  bad.col(3).setZero();
  CHECK_FALSE(lu.factorize(bad.data()));
  bad = a;
  bad(2, 5) = NAN;
  CHECK_FALSE(lu.factorize(bad.data()));
  REQUIRE(lu.factorize(a.data()));
  judge(lu, a, generator);
}

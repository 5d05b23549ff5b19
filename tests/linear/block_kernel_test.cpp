// Partial elimination of dense blocks: every size by the same checks, against Eigen where the result is unique.
#include <catch2/catch.hpp>
#include <random>

#include "linear/dense_matrix.hpp"
#include "linear/partial_lu.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::VectorXd;

namespace {

Block random_block(std::mt19937& generator, int rows, int columns, int width) {
  std::normal_distribution<double> normal;
  Block a = Block::Zero(rows, width);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) a(i, j) = normal(generator);
  return a;
}

struct Kernel {
  BlockKernel kernel;
  int columns;  // without padding
};

/// Whatever rows were chosen as pivots: for any x, b = A x must be reduced to S x_rest, and x_pivots come back.
void check(const Kernel& k, int border, unsigned seed) {
  CAPTURE(k.kernel.rows(), k.kernel.pivots(), k.kernel.width(), border);
  std::mt19937 generator(seed);
  const int rows = k.kernel.rows(), pivots = k.kernel.pivots();
  const Block a = random_block(generator, rows + border, k.columns, k.kernel.width());
  Block lu = a;
  std::vector<int> swaps(static_cast<std::size_t>(pivots) + 1);
  REQUIRE(k.kernel.eliminate(lu.data(), border, swaps.data()));
  for (int trial = 0; trial < 3; ++trial) {
    const VectorXd x = random_block(generator, k.columns, 1, 1);
    VectorXd b = a.leftCols(k.columns) * x;
    k.kernel.forward(lu.data(), border, swaps.data(), b.data());
    const auto schur = lu.block(pivots, pivots, rows + border - pivots, k.columns - pivots);
    // 1e-9: random blocks of up to 70 pivots have condition numbers up to about 1e4.
    CHECK((b.tail(rows + border - pivots) - schur * x.tail(k.columns - pivots)).norm() < 1e-9 * (1 + b.norm()));
    VectorXd found = VectorXd::Zero(k.kernel.width());  // the padding must be zero
    found.head(k.columns) = x;
    found.head(pivots).setConstant(NAN);
    k.kernel.backward(lu.data(), b.data(), found.data());
    CHECK((found.head(k.columns) - x).norm() < 1e-8 * x.norm());
  }
}

/// Weights of the condensed rows turned into weights of the original rows give the same weighted sums.
void check_transposed(const Kernel& k, unsigned seed) {
  CAPTURE(k.kernel.rows(), k.kernel.pivots(), k.kernel.width());
  std::mt19937 generator(seed);
  const int rows = k.kernel.rows(), pivots = k.kernel.pivots();
  Block lu = random_block(generator, rows, k.columns, k.kernel.width());
  std::vector<int> swaps(static_cast<std::size_t>(pivots) + 1);
  REQUIRE(k.kernel.eliminate(lu.data(), 0, swaps.data()));
  VectorXd weights = VectorXd::Zero(rows);
  weights.tail(rows - pivots) = random_block(generator, rows - pivots, 1, 1);
  const VectorXd condensed_weights = weights;
  k.kernel.forward_transposed(lu.data(), swaps.data(), weights.data());
  VectorXd b = random_block(generator, rows, 1, 1);
  const double wanted = weights.dot(b);
  k.kernel.forward(lu.data(), 0, swaps.data(), b.data());
  CHECK(std::abs(condensed_weights.dot(b) - wanted) < 1e-9 * (1 + weights.norm() * b.norm()));
}

}  // namespace

TEST_CASE("interval and join blocks of all sizes, compiled in or not, with and without border rows") {
  // n = 2..6 with c = 2..5 have code of their own for one and two scalars; 1, 7 and 20, c = 7, three scalars have not.
  for (const int n : {1, 2, 3, 4, 5, 6, 7, 20})
    for (const int scalars : {1, 2, 3})
      for (const int border : {0, 1, 2}) {
        for (const int c : {2, 3, 4, 5, 7})
          if (n < 20 || c < 5) check({interval_kernel(n, c, scalars), (c + 1) * n + scalars}, border, 7);
        check({join_kernel(n, scalars), 3 * n + scalars}, border, 8);
      }
}

TEST_CASE("forward elimination and its transpose agree") {
  for (const int n : {1, 3, 4, 8}) {
    for (const int c : {2, 4, 7}) check_transposed({interval_kernel(n, c, 2), (c + 1) * n + 2}, 3);
    check_transposed({join_kernel(n, 2), 3 * n + 2}, 4);
  }
}

TEST_CASE("widths are padded to whole vectors") {
  for (const int n : {2, 3, 4, 5})
    for (const int scalars : {1, 2, 3}) {
      CHECK(interval_kernel(n, 4, scalars).width() % row_padding == 0);
      CHECK(interval_kernel(n, 4, scalars).width() >= 5 * n + scalars);
      CHECK(interval_kernel(n, 4, scalars).rows() == 4 * n);
      CHECK(interval_kernel(n, 4, scalars).pivots() == 3 * n);
    }
}

TEST_CASE(
    "with as many pivots as rows the border rows become the Schur complement, pivots multiply to the determinant") {
  for (const int n : {1, 3, 4, 5, 8, 13}) {
    const int border = 3, rest = 6, width = padded(n + rest);
    std::mt19937 generator(11);
    for (int trial = 0; trial < 8; ++trial) {
      const Block a = random_block(generator, n + border, n + rest, width);
      Block lu = a;
      std::vector<int> swaps(static_cast<std::size_t>(n));
      REQUIRE(BlockKernel(n, n, width).eliminate(lu.data(), border, swaps.data()));
      const Eigen::MatrixXd pivots = a.topLeftCorner(n, n);
      double determinant = 1.0;
      for (int k = 0; k < n; ++k)  // the diagonal holds reciprocals
        determinant /= swaps[static_cast<std::size_t>(k)] == k ? lu(k, k) : -lu(k, k);
      CHECK(determinant == Approx(test::determinant(pivots)).epsilon(1e-9));
      const Eigen::MatrixXd schur =
          a.block(n, n, border, rest) - a.block(n, 0, border, n) * solve(pivots, a.block(0, n, n, rest));
      CHECK((lu.block(n, n, border, rest) - schur).norm() < 1e-9 * (1 + schur.norm()));
    }
  }
}

TEST_CASE("compiled-in and run-time sizes give the same result") {
  std::mt19937 generator(5);
  const int n = 4, c = 4, width = padded((c + 1) * n + 2);
  const Block a = random_block(generator, c * n + 1, (c + 1) * n + 2, width);
  Block fixed = a, dynamic = a;
  std::vector<int> fixed_swaps(static_cast<std::size_t>((c - 1) * n)), dynamic_swaps = fixed_swaps;
  REQUIRE(eliminate(FixedSizes<16, 12, padded(22)>{}, fixed.data(), 1, fixed_swaps.data()));
  REQUIRE(eliminate(DynamicSizes{16, 12, width}, dynamic.data(), 1, dynamic_swaps.data()));
  CHECK(fixed_swaps == dynamic_swaps);
  CHECK((fixed - dynamic).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("border rows are never pivots, however large") {
  std::mt19937 generator(6);
  Block a = random_block(generator, 5, 8, 8);
  a.row(4) *= 1e8;
  Block lu = a;
  std::vector<int> swaps(4);
  REQUIRE(BlockKernel(4, 4, 8).eliminate(lu.data(), 1, swaps.data()));
  for (const int row : swaps) CHECK(row < 4);
}

TEST_CASE("a zero pivot, NaN and infinity are refused") {
  std::mt19937 generator(6);
  const Block a = random_block(generator, 4, 8, 8);
  std::vector<int> swaps(4);
  const BlockKernel kernel(4, 4, 8);
  Block zero = a;
  zero.col(2).setZero();
  CHECK_FALSE(kernel.eliminate(zero.data(), 0, swaps.data()));
  Block infinite = a;
  infinite(3, 1) = INFINITY;
  CHECK_FALSE(kernel.eliminate(infinite.data(), 0, swaps.data()));
}

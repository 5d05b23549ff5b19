// Determinants of block-cyclic systems against those of the whole matrix, and at numbers that doubles do not hold.
#include "stability/periodic_qz.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/random_matrices.hpp"

using namespace tchat;

namespace {

struct Blocks {
  std::vector<Eigen::MatrixXd> e, a;
};

Blocks random_blocks(int n, int m, std::mt19937& numbers) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(numbers); })); };
  Blocks blocks;
  for (int s = 0; s < m; ++s) {
    blocks.e.push_back(any());
    blocks.a.push_back(any());
  }
  return blocks;
}

/// The rows E_s c_s - A_s c_{s-1}, c_0 = t c_m.
double whole_determinant(const Blocks& blocks, double t) {
  const auto m = static_cast<Eigen::Index>(blocks.e.size());
  const Eigen::Index n = blocks.e.front().rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n * m, n * m);
  for (Eigen::Index s = 0; s < m; ++s) {
    matrix.block(s * n, s * n, n, n) += blocks.e[static_cast<std::size_t>(s)];
    matrix.block(s * n, (s + m - 1) % m * n, n, n) -= (s == 0 ? t : 1.0) * blocks.a[static_cast<std::size_t>(s)];
  }
  return test::determinant(matrix);
}

}  // namespace

TEST_CASE("cyclic determinant: that of the whole matrix, also with singular blocks") {
  std::mt19937 numbers(1);
  for (int n = 1; n <= 6; ++n)
    for (int m = 1; m <= 7; ++m)
      for (const bool singular : {false, true}) {
        Blocks blocks = random_blocks(n, m, numbers);
        if (singular) blocks.e.back().col(0).setZero();
        CyclicDeterminant determinant(blocks.e, blocks.a);
        for (const double t : {1.0, -1.0}) {
          CAPTURE(n, m, singular, t);
          const double expected = whole_determinant(blocks, t);
          CHECK(determinant.at(t).value(1e300) == Approx(expected).epsilon(1e-9));
        }
      }
}

TEST_CASE("cyclic determinant: products that doubles do not hold, and no states at all") {
  Blocks blocks;
  for (int s = 0; s < 64; ++s) {
    blocks.e.push_back(1e-30 * Eigen::MatrixXd::Identity(3, 3));
    blocks.a.push_back(2e-30 * Eigen::MatrixXd::Identity(3, 3));
  }
  ScaledReal scale;
  for (int k = 0; k < 64 * 3; ++k) scale *= 1e-30;
  ScaledReal value = CyclicDeterminant(blocks.e, blocks.a).at(1.0);
  CHECK(value.value(1e99) == 0.0);
  value /= scale;
  CHECK(value.value(1e99) == Approx(std::pow(1 - std::pow(2.0, 64), 3)).epsilon(1e-10));
  CHECK(value.value(1e10) == -1e10);
  const std::vector<Eigen::MatrixXd> none(2, Eigen::MatrixXd(0, 0));
  CHECK(CyclicDeterminant(none, none).at(1.0).value(1e99) == 1.0);
}

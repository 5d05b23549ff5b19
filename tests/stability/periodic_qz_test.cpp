// The periodic QZ algorithm alone: random products, factors with known eigenvalues, singular factors.
#include <catch2/catch.hpp>
#include <random>

#include "linear/dense_matrix.hpp"
#include "stability/periodic_qz.hpp"
#include "support/multiplier_sets.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::MatrixXd;

namespace {

struct Product {
  std::vector<MatrixXd> a, e;
};

Product random_product(std::mt19937& generator, int n, int m) {
  Product p;
  for (int s = 0; s < m; ++s) {
    p.a.push_back(random_matrix(generator, n, n));
    p.e.push_back(random_matrix(generator, n, n));
  }
  return p;
}

Multipliers periodic_qz(const Product& p, double cap = 1e99) {
  const int n = static_cast<int>(p.a[0].rows()), m = static_cast<int>(p.a.size());
  PeriodicQz qz(n, m);
  for (int s = 0; s < m; ++s)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        qz.a(s, i, j) = p.a[static_cast<std::size_t>(s)](i, j);
        qz.e(s, i, j) = p.e[static_cast<std::size_t>(s)](i, j);
      }
  REQUIRE(qz.compute());
  Multipliers values;
  for (const ScaledComplex& mu : qz.eigenvalues()) values.push_back(mu.value(cap));
  return values;
}

/// lambda E_s c_s = A_s c_{s-1} (s cyclic) as one pencil of size n m: each eigenvalue's m-th power is an eigenvalue of
/// the product, and each of those comes m times. Values of E-singular directions are infinite and left out.
Multipliers block_cyclic_qz(const Product& p) {
  const Eigen::Index n = p.a[0].rows(), m = static_cast<Eigen::Index>(p.a.size());
  MatrixXd a = MatrixXd::Zero(n * m, n * m), e = a;
  for (Eigen::Index s = 0; s < m; ++s) {
    a.block(s * n, (s + m - 1) % m * n, n, n) = p.a[static_cast<std::size_t>(s)];
    e.block(s * n, s * n, n, n) = p.e[static_cast<std::size_t>(s)];
  }
  Multipliers values;
  for (const std::complex<double>& value : finite_eigenvalues(a, e))
    values.push_back(std::pow(value, static_cast<int>(m)));
  return values;
}

double distance_to_nearest(const std::complex<double>& mu, const Multipliers& values) {
  double nearest = INFINITY;
  for (const auto& value : values) nearest = std::min(nearest, std::abs(value - mu));
  return nearest / (1e-3 + std::abs(mu));
}

/// E_s^-1 A_s = X_s D_s X_{s-1}^-1 with D_s diagonal: the eigenvalues are the products of the diagonals.
Product product_with(std::mt19937& generator, const std::vector<std::vector<double>>& diagonals) {
  const int m = static_cast<int>(diagonals.size()), n = static_cast<int>(diagonals[0].size());
  std::vector<MatrixXd> x;
  for (int s = 0; s < m; ++s) x.push_back(random_orthogonal(generator, n));
  Product p;
  for (int s = 0; s < m; ++s) {
    const auto index = static_cast<std::size_t>(s);
    const MatrixXd left = random_orthogonal(generator, n);
    const Eigen::Map<const Eigen::VectorXd> d(diagonals[index].data(), n);
    p.e.push_back(left * x[index].transpose());
    p.a.push_back(left * d.asDiagonal() * x[static_cast<std::size_t>((s + m - 1) % m)].transpose());
  }
  return p;
}

}  // namespace

TEST_CASE("periodic QZ agrees with the block-cyclic QZ on random products") {
  std::mt19937 generator(1);
  for (const int n : {1, 2, 3, 4, 6, 9})
    for (const int m : {1, 2, 3, 5, 8}) {
      CAPTURE(n, m);
      const Product p = random_product(generator, n, m);
      const Multipliers found = periodic_qz(p), reference = block_cyclic_qz(p);
      REQUIRE(reference.size() == static_cast<std::size_t>(n * m));
      // Eigenvalues of a random product are moderately conditioned: 1e-8 leaves room for condition numbers of 1e6.
      for (const auto& mu : found) CHECK(distance_to_nearest(mu, reference) < 1e-8);
      for (const auto& mu : reference) CHECK(distance_to_nearest(mu, found) < 1e-8);
    }
}

TEST_CASE("periodic QZ of one factor is the eigenvalue problem of a matrix, of any size") {
  std::mt19937 generator(2);
  for (const int n : {1, 2, 5, 12, 30}) {
    Product p{{random_matrix(generator, n, n)}, {MatrixXd::Identity(n, n)}};
    const Eigen::VectorXcd exact = eigenvalues(p.a[0]);
    CHECK(mixed_distance(periodic_qz(p), {exact.begin(), exact.end()}) < 1e-10);
  }
  CHECK(PeriodicQz(0, 3).compute());
}

TEST_CASE("periodic QZ keeps eigenvalues from 1e-200 to 1e80 apart, each to nearly full relative accuracy") {
  std::mt19937 generator(3);
  const int m = 40;
  std::vector<std::vector<double>> diagonals;
  for (int s = 0; s < m; ++s) diagonals.push_back({1e-5, 0.3, -0.9, 1.1, 1e2});
  const Multipliers expected{1e-200, std::pow(0.3, m), std::pow(-0.9, m), std::pow(1.1, m), 1e80};
  // Rounding in 40 factors, as seen from eigenvalues that differ by a factor of 1e7 in each.
  CHECK(relative_distance(periodic_qz(product_with(generator, diagonals)), expected) < 1e-8);
}

TEST_CASE("periodic QZ: products of any number of factors, powers among them") {
  std::mt19937 generator(6);
  for (const int n : {2, 3, 6})
    for (const int m : {16, 64, 256, 1024}) {
      CAPTURE(n, m);
      periodic_qz(random_product(generator, n, m));  // REQUIREs that it converges
      const Product once = random_product(generator, n, 1);
      PeriodicQz qz(n, m);
      for (int s = 0; s < m; ++s)
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) qz.a(s, i, j) = once.a[0](i, j), qz.e(s, i, j) = once.e[0](i, j);
      REQUIRE(qz.compute());
      std::vector<double> sizes, expected;  // log2 of moduli, which no double need hold
      for (const ScaledComplex& mu : qz.eigenvalues())
        sizes.push_back((std::log2(std::abs(mu.mantissa)) + static_cast<double>(mu.exponent)) / m);
      const Eigen::VectorXcd exact = eigenvalues(once.e[0].partialPivLu().solve(once.a[0]));
      for (const auto& mu : exact) expected.push_back(std::log2(std::abs(mu)));
      std::sort(sizes.begin(), sizes.end());
      std::sort(expected.begin(), expected.end());
      // Rounding times the condition of eigenvalues of a random pair.
      for (std::size_t k = 0; k < sizes.size(); ++k) CHECK(std::abs(sizes[k] - expected[k]) < 1e-11);
    }
}

TEST_CASE("periodic QZ: rows of a pair that are small in both factors say nothing of the eigenvalues' sizes") {
  std::mt19937 generator(7);
  for (int trial = 0; trial < 20; ++trial) {
    CAPTURE(trial);
    Product p = random_product(generator, 3, 1);
    const Eigen::VectorXcd exact = eigenvalues(p.e[0].partialPivLu().solve(p.a[0]));
    for (MatrixXd* factor : {&p.a[0], &p.e[0]}) factor->row(trial % 3) *= 1e-10;
    // Rounding beside the other rows, 1e-6 of this one, times the condition of the eigenvalues.
    CHECK(mixed_distance(periodic_qz(p), {exact.begin(), exact.end()}) < 1e-3);
  }
}

TEST_CASE("periodic QZ: blocks that look graded in a matrix whose eigenvalues all have one size") {
  for (const double g : {1e-5, 0.001, 0.035, 0.2, 0.7, 0.999})
    for (const double sign : {1.0, -1.0})
      for (const int factors : {1, 3}) {
        CAPTURE(g, sign, factors);
        const double c = sign * std::sqrt(1.0 - g * g);
        MatrixXd a(4, 4);
        a << g, 0, 0, c, c, 0, 0, -g, 0, 1, 0, 0, 0, 0, 1, 0;
        Product p{{a}, {MatrixXd::Identity(4, 4)}};
        for (int s = 1; s < factors; ++s) p.a.push_back(p.e[0]), p.e.push_back(p.e[0]);
        for (const auto& mu : periodic_qz(p)) CHECK(std::abs(mu) == Approx(1.0).margin(1e-12));
      }
}

TEST_CASE("periodic QZ: growth and decay in turns cancel without loss") {
  std::mt19937 generator(4);
  std::vector<std::vector<double>> diagonals;
  for (int s = 0; s < 8; ++s)
    diagonals.push_back(s % 2 == 0 ? std::vector<double>{1e3, 1e-3, 2.0} : std::vector<double>{1e-3, 1e3, 0.25});
  const Multipliers found = periodic_qz(product_with(generator, diagonals));
  // The eigenvalue 1 is double; rounding splits it at first order, as the eigenvectors are orthogonal.
  CHECK(relative_distance(found, {1.0, 1.0, 1.0 / 16}) < 1e-7);
}

TEST_CASE("periodic QZ with singular factors: zero and infinite eigenvalues, the finite ones unharmed") {
  std::mt19937 generator(5);
  std::vector<std::vector<double>> diagonals{{2.0, -3.0, 0.5}, {1.5, 1.0, 0.25}, {-1.0, 2.0, 4.0}};
  const Multipliers regular{-3.0, -6.0, 0.5};
  SECTION("A_2 singular: one eigenvalue zero") {
    diagonals[1][1] = 0.0;
    CHECK(absolute_distance(periodic_qz(product_with(generator, diagonals)), {-3.0, 0.0, 0.5}) < 1e-13);
  }
  SECTION("A_1 singular") {
    diagonals[0][2] = 0.0;
    CHECK(absolute_distance(periodic_qz(product_with(generator, diagonals)), {-3.0, -6.0, 0.0}) < 1e-13);
  }
  SECTION("an E singular: one eigenvalue infinite to rounding") {
    // M^-1 is the product of the pairs (E_s, A_s) in reverse order: a zero of M is an infinite eigenvalue of it.
    diagonals[1][1] = 0.0;
    const Product p = product_with(generator, diagonals);
    const Product inverse{{p.e.rbegin(), p.e.rend()}, {p.a.rbegin(), p.a.rend()}};
    Multipliers found = periodic_qz(inverse);
    const auto smaller = [](const auto& x, const auto& y) { return std::abs(x) < std::abs(y); };
    const auto largest = std::max_element(found.begin(), found.end(), smaller);
    CHECK(std::abs(*largest) > 1e12);
    found.erase(largest);
    CHECK(absolute_distance(found, {-1.0 / 3.0, 2.0}) < 1e-12);
    Multipliers reference = block_cyclic_qz(inverse);
    for (const auto& mu : found) CHECK(distance_to_nearest(mu, reference) < 1e-6);
  }
  SECTION("all regular") { CHECK(absolute_distance(periodic_qz(product_with(generator, diagonals)), regular) < 1e-12); }
}

TEST_CASE("periodic QZ: values beyond the cap are cut back to it, input that is not finite is refused") {
  Product p{{MatrixXd::Constant(1, 1, -1e200), MatrixXd::Constant(1, 1, 1e200)},
            {MatrixXd::Identity(1, 1), MatrixXd::Identity(1, 1)}};
  CHECK(std::abs(periodic_qz(p)[0] - std::complex<double>(-1e99)) < 1e85);
  p.a[1](0, 0) = 1e-300;
  p.a[0](0, 0) = 1e-300;
  CHECK(periodic_qz(p)[0] == 0.0);
  PeriodicQz qz(1, 1);
  qz.a(0, 0, 0) = NAN;
  qz.e(0, 0, 0) = 1.0;
  CHECK_FALSE(qz.compute());
}

TEST_CASE("conjugate pairs are made exact, real values real") {
  Multipliers values{{0.3, 1e-17}, {0.5, 0.7}, {-2.0, -3e-16}, {0.5 + 1e-15, -0.7}, {1e-12, -2e-3}, {1e-12, 2e-3}};
  conjugate_pairs(values);
  CHECK(values[0].imag() == 0.0);
  CHECK(values[2].imag() == 0.0);
  CHECK(values[1] == std::conj(values[3]));
  CHECK(values[4] == std::conj(values[5]));
  CHECK(values[4].imag() > 0.0);
  CHECK(std::abs(values[1] - std::complex<double>(0.5, 0.7)) < 1e-15);
  Multipliers none;
  conjugate_pairs(none);
  CHECK(none.empty());
}

// Lyapunov exponents of maps: matrices whose eigenvalues are known, the Henon and logistic maps.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "motion/growth_series.hpp"

using namespace tchat;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;

TEST_CASE("matrices: the exponents of a constant matrix are logarithms of its eigenvalues") {
  QrAccumulator cat_map(2, 2);
  const Matrix2d a{{2, 1}, {1, 1}};
  for (int i = 0; i < 2000; ++i) cat_map.pass(a);
  const double expected = std::log(0.5 * (3.0 + std::sqrt(5.0)));
  CHECK(cat_map.spectrum().exponents(0) == Approx(expected).epsilon(1e-12));
  CHECK(cat_map.spectrum().exponents(1) == Approx(-expected).epsilon(1e-12));
  CHECK(cat_map.spectrum().errors.maxCoeff() < 1e-10);

  // Eigenvalues 0.5 exp(+-i), of a matrix far from normal, and 3; durations 2.
  const Matrix3d shear{{1, 7, 2}, {0, 1, -3}, {0, 0, 1}};
  Matrix3d rotation = Matrix3d::Zero();
  rotation.topLeftCorner<2, 2>() << 0.5 * std::cos(1.0), -0.5 * std::sin(1.0), 0.5 * std::sin(1.0), 0.5 * std::cos(1.0);
  rotation(2, 2) = 3.0;
  const Matrix3d b = shear * rotation * shear.inverse();
  QrAccumulator turning(3, 3);
  for (int i = 0; i < 6000; ++i) turning.pass(b, 2.0);
  const LyapunovSpectrum s = turning.spectrum();
  CHECK(s.exponents(0) == Approx(0.5 * std::log(3.0)).epsilon(1e-12));
  CHECK(std::abs(s.exponents(1) - 0.5 * std::log(0.5)) < 1e-8);
  CHECK(std::abs(s.exponents(2) - 0.5 * std::log(0.5)) < 1e-8);
  CHECK(s.errors.maxCoeff() < 1e-4);
  CHECK(s.time == 12000.0);
  CHECK(s.events == 6000);
}

TEST_CASE("matrices: nothing overflows, a lost direction is minus infinity, what is not finite is left out") {
  QrAccumulator large(2, 2), singular(3, 3), broken(2, 1);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto random_matrix = [&] { return MatrixXd::NullaryExpr(3, 3, [&] { return normal(random); }); };
  for (int i = 0; i < 500; ++i) {
    large.pass(Matrix2d{{1e100, 0.0}, {0.0, 1e-100}});
    MatrixXd a = random_matrix();
    if (i % 10 == 0) a.row(2) = a.row(0) + a.row(1);
    singular.pass(a);
    broken.pass(i == 3 ? Matrix2d::Constant(NAN) : Matrix2d(2.0 * Matrix2d::Identity()));
  }
  CHECK(large.spectrum().exponents(0) == Approx(100.0 * std::log(10.0)));
  CHECK(large.spectrum().exponents(1) == -INFINITY);  // 1e-200 of the other one is below rounding
  CHECK(std::isfinite(singular.spectrum().exponents(1)));
  CHECK(singular.spectrum().exponents(2) == -INFINITY);
  CHECK(broken.spectrum().exponents(0) == Approx(std::log(2.0)));
  CHECK(broken.spectrum().tangential == 1);
  CHECK(broken.spectrum().events == 499);
}

TEST_CASE("Henon map: published exponents, and bars that are honest in 40 runs") {
  // a = 1.4, b = 0.3: 0.41922 (Sprott, Chaos and Time-Series Analysis, 2003: 0.41922 and -1.62319), sum ln 0.3.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> start(-0.1, 0.1);
  int within = 0;
  for (int run = 0; run < 40; ++run) {
    double x = start(random), y = start(random);
    QrAccumulator exponents(2, 2);
    for (int i = 0; i < 4100; ++i) {
      if (i >= 100) exponents.pass(Matrix2d{{-2.8 * x, 1.0}, {0.3, 0.0}});
      const double next = 1.0 - 1.4 * x * x + y;
      y = 0.3 * x;
      x = next;
    }
    const LyapunovSpectrum s = exponents.spectrum();
    CHECK(s.exponents.sum() == Approx(std::log(0.3)).epsilon(1e-6));
    CHECK(s.errors(0) < 0.02);
    within += std::abs(s.exponents(0) - 0.41922) <= 2.0 * s.errors(0) ? 1 : 0;
  }
  CHECK(within >= 36);
}

TEST_CASE("logistic map beside a window: laminar phases correlate blocks, the bars are honest all the same") {
  // a = 3.8282, before the window of period 3 at 1 + sqrt(8) = 3.82843: laminar phases of some hundred iterates.
  const auto exponent = [](double x, long iterates) {
    double sum = 0.0;
    for (long i = 0; i < iterates; ++i) {
      sum += std::log(std::abs(3.8282 * (1.0 - 2.0 * x)));
      x = 3.8282 * x * (1.0 - x);
    }
    return sum / static_cast<double>(iterates);
  };
  const double long_run = exponent(0.3456, 20000000);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> start(0.1, 0.9);
  int within = 0, within_of_plain = 0;
  for (int run = 0; run < 40; ++run) {
    double x = start(random);
    QrAccumulator exponents(1, 1);
    double squares = 0.0;
    constexpr int count = 10000;
    for (int i = 0; i < count; ++i) {
      const double factor = 3.8282 * (1.0 - 2.0 * x);
      exponents.pass(MatrixXd::Constant(1, 1, factor));
      squares += std::pow(std::log(std::abs(factor)) - long_run, 2);
      x = 3.8282 * x * (1.0 - x);
    }
    const LyapunovSpectrum s = exponents.spectrum();
    const double error = std::abs(s.exponents(0) - long_run);
    within += error <= 2.0 * s.errors(0) ? 1 : 0;
    within_of_plain += error <= 2.0 * std::sqrt(squares) / count ? 1 : 0;
  }
  CAPTURE(long_run, within_of_plain);
  CHECK(within >= 36);
}

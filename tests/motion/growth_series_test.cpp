// Means of growth and their error bars: sequences whose mean and variance are known in closed form.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "motion/growth_series.hpp"

using namespace tchat;
using Eigen::VectorXd;

namespace {

LyapunovSpectrum spectrum_of(int pieces, const std::function<double(int)>& growth) {
  GrowthSeries series(1);
  for (int i = 0; i < pieces; ++i) series.add(VectorXd::Constant(1, growth(i)), 1.0);
  return series.spectrum();
}

}  // namespace

TEST_CASE("growth series: the bar of independent pieces is sigma / sqrt(N)") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const int pieces : {500, 3000, 100000}) {
    CAPTURE(pieces);
    double mean_of_bars = 0.0;
    for (int run = 0; run < 20; ++run)
      mean_of_bars += spectrum_of(pieces, [&](int) { return 0.3 + normal(random); }).errors(0) / 20.0;
    // The larger one of two bars is larger than one on average, by some percent.
    CHECK(mean_of_bars > 0.95 / std::sqrt(pieces));
    CHECK(mean_of_bars < 1.3 / std::sqrt(pieces));
  }
}

TEST_CASE("growth series: bars of correlated pieces are honest") {
  // y' = phi y + normal: the mean of N has the deviation 1 / (1 - phi) / sqrt(N), a plain standard error would say
  // 1 / sqrt((1 - phi^2) N), six times less.
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr double phi = 0.95;
  int within = 0;
  double mean_of_bars = 0.0;
  for (int run = 0; run < 40; ++run) {
    double y = normal(random) / std::sqrt(1.0 - phi * phi);
    const LyapunovSpectrum s = spectrum_of(20000, [&](int) { return y = phi * y + normal(random); });
    within += std::abs(s.exponents(0)) <= 2.0 * s.errors(0) ? 1 : 0;
    mean_of_bars += s.errors(0) / 40.0;
  }
  CHECK(within >= 36);
  CHECK(mean_of_bars == Approx(1.0 / (1.0 - phi) / std::sqrt(20000.0)).epsilon(0.3));
}

TEST_CASE("growth series: a rate that changes along the motion has a bar as large as the change") {
  // 0.1 in the first half, 0.3 in the second: what the motion goes on with is 0.1 away from the mean.
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const LyapunovSpectrum s = spectrum_of(4000, [&](int i) { return (i < 2000 ? 0.1 : 0.3) + 0.01 * normal(random); });
  CHECK(s.errors(0) > 0.09);
}

TEST_CASE("growth series: the bar of a rate that falls like 1 / t reaches its limit, however late it is looked at") {
  for (const double before : {0.0, 1e3, 1e5}) {
    CAPTURE(before);
    GrowthSeries series(1);
    for (int i = 0; i < 1024; ++i) series.add(VectorXd::Constant(1, -0.2 - 1.5 / (before + i + 1.0)), 1.0);
    const LyapunovSpectrum s = series.spectrum(0, before);
    CHECK(std::abs(s.exponents(0) + 0.2) <= 2.0 * s.errors(0));
    CHECK(s.errors(0) < 4.0 * std::abs(s.exponents(0) + 0.2));
  }
}

TEST_CASE("growth series: what the next piece takes back does not count") {
  // Differences of normal numbers: their sum stays bounded.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  double before = normal(random);
  const LyapunovSpectrum s = spectrum_of(8000, [&](int) {
    const double last = std::exchange(before, normal(random));
    return before - last;
  });
  CHECK(std::abs(s.exponents(0)) <= 2.0 * s.errors(0));
  CHECK(s.errors(0) < 0.1 / std::sqrt(8000.0));
}

TEST_CASE("growth series: quasi-periodic motion converges faster than any power") {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0) * 2.0 * 3.14159265358979323846;
  const LyapunovSpectrum s =
      spectrum_of(8000, [&](int i) { return -0.25 + std::cos(golden * i) + 0.5 * std::sin(1.0 + 2.0 * golden * i); });
  CHECK(std::abs(s.exponents(0) + 0.25) < 1e-12);  // a plain mean: 1e-4
  CHECK(s.errors(0) < 1e-8);
  CHECK(std::abs(s.exponents(0) + 0.25) <= 2.0 * s.errors(0) + 1e-14);
}

TEST_CASE("growth series: durations that differ, many pieces, pieces of double length") {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  for (const int pieces : {16, 1000, 8191, 8192, 8193, 50000}) {
    CAPTURE(pieces);
    GrowthSeries series(2);
    VectorXd sums = VectorXd::Zero(2);
    double time = 0.0;
    for (int i = 0; i < pieces; ++i) {
      const double duration = uniform(random);
      const VectorXd growth = Eigen::Vector2d(uniform(random), -2.0 * duration);
      series.add(growth, duration);
      sums += growth;
      time += duration;
      if (i % 700 == 699 && series.pieces() % 2 == 0 && series.pieces() > 600) series.double_pieces();
    }
    const LyapunovSpectrum s = series.spectrum();
    CHECK(s.time == Approx(time).epsilon(1e-12));
    // The last bin is left out when it is not complete.
    CHECK(s.exponents(0) == Approx(sums(0) / time).epsilon(0.01));
    CHECK(s.exponents(1) == Approx(-2.0).epsilon(1e-12));
  }
}

TEST_CASE("growth series: few pieces have no bar, a lost direction is minus infinity") {
  CHECK(std::isinf(spectrum_of(15, [](int i) { return i; }).errors(0)));
  CHECK(std::isfinite(spectrum_of(16, [](int i) { return i; }).errors(0)));
  CHECK(std::isnan(GrowthSeries(1).spectrum().exponents(0)));
  const LyapunovSpectrum s = spectrum_of(3000, [](int i) { return i == 7 ? -INFINITY : 1.0; });
  CHECK(s.exponents(0) == -INFINITY);
  CHECK(s.errors(0) == 0.0);
}

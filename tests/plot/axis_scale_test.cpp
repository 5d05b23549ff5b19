#include "plot/figure.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "base/messages.hpp"

using namespace tchat;

TEST_CASE("the range holds the data, tics are round and enough") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-6.0, 6.0), part(-1.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    const double size = std::pow(10.0, exponent(random));
    const double offset = 10.0 * size * part(random);
    const std::vector<double> values{offset, offset + size * part(random), offset - size};
    const AxisScale scale = choose_scale({}, values, 8);
    for (const double value : values) {
      CHECK(scale.fraction(value) > 0.0);
      CHECK(scale.fraction(value) < 1.0);
    }
    const double steps = (scale.high - scale.low) / scale.tic_step;
    CHECK(steps >= 3.0);
    CHECK(steps <= 8.0 + 1e-9);
    const double leading = scale.tic_step / std::pow(10.0, std::floor(std::log10(scale.tic_step * 1.0000001)));
    CHECK((std::abs(leading - 1.0) < 1e-9 || std::abs(leading - 2.0) < 1e-9 || std::abs(leading - 5.0) < 1e-9));
  }
}

TEST_CASE("constants, infinities in files and nothing at all") {
  const AxisScale constant = choose_scale({}, {1.0, 1.0 + 1e-12, 1e99, std::nan("")}, 8);
  CHECK(constant.low < 0.99);
  CHECK(constant.high > 1.01);
  CHECK(constant.high < 2.0);
  CHECK(choose_scale({}, {}, 8).high > choose_scale({}, {}, 8).low);
  CHECK_FALSE(can_be_shown(1e99));
  CHECK(choose_scale({}, {0.0, 0.0}, 8).low < 0.0);
}

TEST_CASE("ends that the user chose are kept") {
  AxisSettings settings;
  settings.low = 0.5;
  settings.high = 2.0;
  const AxisScale scale = choose_scale(settings, {-10.0, 10.0}, 8);
  CHECK(scale.low == 0.5);
  CHECK(scale.high == 2.0);
  AxisSettings low_only;
  low_only.low = 20.0;  // beyond all data
  const AxisScale beyond = choose_scale(low_only, {1.0, 2.0}, 8);
  CHECK(beyond.low == 20.0);
  CHECK(beyond.high > 20.0);
}

TEST_CASE("logarithmic axes show positive values") {
  AxisSettings settings;
  settings.logarithmic = true;
  const AxisScale scale = choose_scale(settings, {1.0, 100.0, -3.0, 0.0}, 8);
  CHECK(scale.fraction(10.0) == Approx(0.5));
  CHECK(std::isnan(scale.fraction(-1.0)));
  CHECK_THROWS_AS(choose_scale(settings, {-1.0}, 8), UserError);
  settings.low = -1.0;
  CHECK_THROWS_AS(choose_scale(settings, {1.0}, 8), UserError);
}

// When the values of an oscillating function are taken for resolved, on functions whose zeros are known.
#include "continuation/branch_point_bracket.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

using namespace tchat;

namespace {

using Function = std::function<double(double)>;

std::vector<TrendValue> sampled(const Function& f, const std::vector<double>& places) {
  std::vector<TrendValue> result;
  for (const double at : places) result.push_back({at, f(at)});
  return result;
}

bool follows(const Function& f, const std::vector<double>& past, double next) {
  return follows_trend(sampled(f, past), {next, f(next)});
}

}  // namespace

TEST_CASE("trend: straight lines, parabolas and well sampled oscillations are followed, through zeros too") {
  CHECK(follows([](double t) { return 0.3 - t; }, {0.0, 0.1, 0.2}, 0.4));
  CHECK(follows([](double t) { return 1.0 + (t - 0.3) * (t - 0.3); }, {0.0, 0.1, 0.2}, 0.4));
  for (const double step : {0.1, 0.3, 0.6})
    for (double phase = 0.0; phase < 6.3; phase += 0.01) {
      INFO("step " << step << ", phase " << phase);
      CHECK(follows([=](double t) { return std::sin(t + phase); }, {0.0, step, 2.0 * step}, 3.0 * step));
    }
}

TEST_CASE("trend: too little is known at first") {
  const Function any = [](double t) { return std::cos(50.0 * t); };
  CHECK(follows(any, {}, 1.0));
  CHECK(follows(any, {0.5}, 1.0));
}

TEST_CASE("trend: a value far from what is expected is not followed") {
  CHECK_FALSE(follows([](double t) { return std::sin(t); }, {0.0, 1.0, 2.0}, 2.0 + 1.5 * M_PI));
  CHECK_FALSE(follows([](double t) { return t < 1.0 ? 1.0 : 3.0; }, {0.0, 0.4, 0.8}, 1.2));
}

TEST_CASE("trend: two zeros within a step are never passed, wherever the points lie") {
  // a + cos t falls below zero around t = pi, between pi -+ acos(a).
  int steps = 0;
  for (const double a : {0.8, 0.9, 0.95, 0.99, 0.999, 0.9999})
    for (const double step : {0.2, 0.5, 0.8, 1.1})
      for (double last = M_PI - step; last < M_PI; last += 0.01) {
        const double low = M_PI - std::acos(a), high = M_PI + std::acos(a);
        if (!(last < low && last + step > high)) continue;
        INFO("a = " << a << ", step = " << step << ", last = " << last);
        const Function wave = [=](double t) { return a + std::cos(t); };
        CHECK_FALSE(follows(wave, {last - 2.0 * step, last - step, last}, last + step));
        CHECK_FALSE(follows(wave, {last - 1.0 * step, last - 0.5 * step, last}, last + step));
        ++steps;
      }
  CHECK(steps > 100);
}

TEST_CASE("trend: a special point next to the last one does not spoil it") {
  // Two values 1e-9 apart with an error of 1e-9 would foretell anything.
  const std::vector<TrendValue> past{{0.0, 1.0}, {0.1, 0.9}, {0.2, 0.8}, {0.2 + 1e-9, 0.8 + 1e-9}};
  CHECK(follows_trend(past, {0.3, 0.7}));
  CHECK_FALSE(follows_trend(past, {0.3, -0.2}));
}

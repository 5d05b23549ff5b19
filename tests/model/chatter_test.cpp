// The limit of infinitely many impacts, against impacts one by one in closed form: a ball above a table, whose flights
// are parabolas over a sine.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <tchat/problem.hpp>

#include "support/ball_impacts.hpp"

namespace {

/// height, velocity, table and its other coordinate in units; Gamma, r and the units are parameters.
struct BallInUnits {
  static constexpr int dimension = 4, parameters = 6, fields = 2, events = 3, jumps = 4;
  static constexpr tchat::Chatter chatter{
      .field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2, .limit = 3, .margin = 3, .leave = 4, .time = 0};

  template <class T>
  void field(int, const T* y, const T* par, T* f) const {
    const T table = y[2] * par[4], w = y[3] * par[5];
    const T growth = 1.0 - (table * table + w * w) / (par[0] * par[0]);
    f[0] = y[1] * par[3] / par[2];
    f[1] = T(-1.0) / par[3];
    f[2] = (growth * table + w) / par[4];
    f[3] = (growth * w - table) / par[5];
  }
  template <class T>
  T event(int, const T* y, const T* par) const {
    return y[0] * par[2] - y[2] * par[4];
  }
  template <class T>
  void jump(int k, const T* y, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = y[i];
    const T table = y[2] * par[4], w = y[3] * par[5];
    const T growth = 1.0 - (table * table + w * w) / (par[0] * par[0]);
    if (k == 1) g[1] = ((1.0 + par[1]) * (growth * table + w) - par[1] * y[1] * par[3]) / par[3];
  }
};

using Functions = tchat::ChatterFunctions<BallInUnits>;
using State = std::array<double, 4>;
using Parameters = std::array<double, 6>;

const BallInUnits ball;
const Functions functions(ball, BallInUnits::chatter);

using Impacts = test_support::BallImpacts;

/// The state before an impact.
State before(const Impacts& impacts, const Parameters& par) {
  const long double sine = par[0] * std::sin(impacts.phase()), cosine = par[0] * std::cos(impacts.phase());
  return {static_cast<double>(sine / par[2]), static_cast<double>(impacts.velocity() / par[3]),
          static_cast<double>(sine / par[4]), static_cast<double>(cosine / par[5])};
}

/// The time until rest, from the first impact on from which the problem sums all up.
double summed_time(Impacts impacts, const Parameters& par) {
  for (;;) {
    const State x = before(impacts, par);
    const int before = functions.impacts_before_limit(x.data(), par.data());
    if (before == 0) return static_cast<double>(impacts.time()) + functions.rest(x.data(), par.data()).time;
    if (before < 0 || !impacts.next()) return -1.0;
  }
}

}  // namespace

TEST_CASE("the time until a ball rests on its table is that of its impacts, one by one") {
  // Known to 14 decimals; impacts are followed until v is 1e-13, with 19 digits.
  const double known[][3] = {{1.1, 0.3, 1.97631881856528}, {1.1, 0.5, 2.23614064627234}, {1.1, 0.7, 2.73213830231654},
                             {1.2, 0.3, 2.74948623542274}, {1.2, 0.5, 3.14849541720213}, {1.4, 0.3, 3.79593375225702},
                             {1.4, 0.5, 4.50634614803606}, {1.05, 0.7, 1.91499181930085}};
  for (const auto& [gamma, r, time] : known) {
    INFO("Gamma = " << gamma << ", r = " << r);
    const Impacts impacts(gamma, r);
    CHECK(std::abs(static_cast<double>(Impacts::time_until_rest(impacts)) - time) < 1e-11);
    CHECK(std::abs(summed_time(impacts, {gamma, r, 1, 1, 1, 1}) - time) < 1e-11);
  }
  CHECK(summed_time(Impacts(1.4, 0.7), {1.4, 0.7, 1, 1, 1, 1}) < 0);
}

TEST_CASE("for any restitution and in any units chatter is complete, or it is not, as impact by impact") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int complete = 0;
  for (int trial = 0; trial < 100; ++trial) {
    Parameters par{1.02 + 0.9 * share(random), 0.05 + 0.9 * share(random)};
    for (std::size_t k = 2; k < par.size(); ++k) par[k] = std::pow(10.0, 18.0 * share(random) - 9.0);
    INFO("Gamma = " << par[0] << ", r = " << par[1]);
    const Impacts impacts(par[0], par[1]);
    const auto time = static_cast<double>(Impacts::time_until_rest(impacts));
    const double summed = summed_time(impacts, par);
    CHECK((time < 0) == (summed < 0));
    if (time >= 0) CHECK(std::abs(summed - time) < 1e-10);
    complete += time >= 0;
  }
  CHECK(complete > 30);
  CHECK(complete < 90);
}

TEST_CASE("from any impact on, also where the next flights are long, what is summed up is what follows") {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int near = 0, far = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double gamma = 1.05 + 4.0 * share(random), r = 0.05 + 0.9 * share(random);
    const double phase = 6.28 * share(random), velocity = -std::pow(10.0, 4.0 * share(random) - 3.0);
    INFO("Gamma = " << gamma << ", r = " << r << ", at t = " << phase << " with v = " << velocity);
    const Parameters par{gamma, r, 1, 1, 1, 1};
    const Impacts impacts(gamma, r, phase, velocity);
    const State x = before(impacts, par);
    const int before = functions.impacts_before_limit(x.data(), par.data());
    const auto time = static_cast<double>(Impacts::time_until_rest(impacts));
    near += before == 0;
    far += before != 0;
    if (before != 0) continue;
    CHECK(time >= 0.0);
    CHECK(std::abs(functions.rest(x.data(), par.data()).time - time) < 1e-9);
  }
  CHECK(near > 100);
  CHECK(far > 100);
  // A flight of 1.19 after which the table moves up fast; there is a longer one that would end as well.
  const Parameters par{4.5, 0.5, 1, 1, 1, 1};
  const State x{-4.499056114749892, -5.791925940137669, -4.499056114749892, 0.09216328013234071};
  CHECK(functions.impacts_before_limit(x.data(), par.data()) != 0);
}

TEST_CASE("derivatives of the limit of chatter agree with differences, and contact keeps the ball on the table") {
  using Dual = tchat::Dual<6>;
  const Parameters par{1.2, 0.5, 1, 1, 1, 1};
  Impacts impacts(par[0], par[1]);
  impacts.next();
  const State x = before(impacts, par);
  std::array<Dual, 4> moving, limit;
  std::array<Dual, 6> with;
  for (std::size_t i = 0; i < 4; ++i) moving[i] = x[i], moving[i].derivative[i] = 1.0;
  for (std::size_t i = 0; i < 6; ++i) with[i] = par[i];
  with[0].derivative[4] = with[1].derivative[5] = 1.0;
  functions.limit(static_cast<const Dual*>(moving.data()), static_cast<const Dual*>(with.data()), limit.data());
  constexpr double step = 1e-4;
  for (std::size_t c = 0; c < 6; ++c) {
    const auto at = [&](double t) {
      State moved = x, result;
      Parameters changed = par;
      (c < 4 ? moved[c] : changed[c - 4]) += t;
      functions.limit(moved.data(), changed.data(), result.data());
      return result;
    };
    const State a = at(step), b = at(-step), aa = at(2 * step), bb = at(-2 * step);
    for (std::size_t i = 0; i < 4; ++i) {
      const double difference = (8.0 * (a[i] - b[i]) - (aa[i] - bb[i])) / (12.0 * step);
      CHECK(std::abs(limit[i].derivative[c] - difference) < 1e-9 * (1.0 + std::abs(difference)));
    }
  }
  State on, f;
  for (std::size_t i = 0; i < 4; ++i) on[i] = limit[i].value;
  CHECK(std::abs(on[0] - on[2]) < 1e-12);
  functions.contact(on.data(), par.data(), f.data());
  CHECK(std::abs(f[0] - f[2]) < 1e-12);
  CHECK(std::abs(f[1] + on[2]) < 1e-12);  // the table's acceleration
}

namespace {

/// A ball on a platform that is driven through a spring, and as heavy as three balls.
struct Platform {
  static constexpr int dimension = 6, parameters = 2, fields = 2, events = 3, jumps = 4;
  static constexpr tchat::Chatter chatter{
      .field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2, .limit = 3, .margin = 3, .leave = 4, .time = 0};

  template <class T>
  void field(int, const T* y, const T* par, T* f) const {
    const T growth = 1.0 - y[4] * y[4] - y[5] * y[5];
    f[0] = y[1];
    f[1] = (-4.0 * y[0] - 0.4 * y[1] + par[0] * y[4]) / 3.0 - 1.0;
    f[2] = y[3];
    f[3] = T(-1.0);
    f[4] = growth * y[4] - par[1] * y[5];
    f[5] = growth * y[5] + par[1] * y[4];
  }
  template <class T>
  T event(int, const T* y, const T*) const {
    return y[2] - y[0];
  }
  template <class T>
  void jump(int k, const T* y, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = y[i];
    if (k != 1) return;
    g[1] = y[1] + 0.35 * (y[3] - y[1]);
    g[3] = y[3] - 1.05 * (y[3] - y[1]);
  }
};

}  // namespace

TEST_CASE("where chatter becomes incomplete the limit has a value on both sides") {
  const Platform platform;
  const tchat::ChatterFunctions<Platform> functions(platform, Platform::chatter);
  const double par[] = {1.7290026101, 1.072654058};
  const std::array<double, 6> before{-0.91406658276, 1.716037906,   -0.91406658276,
                                     1.2737170411,   0.92017690925, 0.39150281696};
  std::array<double, 6> known{}, image{};
  functions.limit(before.data(), par, known.data());
  double least = 1.0, largest = -1.0;  // margin
  for (int k = -2000; k <= 2000; k += 5) {
    std::array<double, 6> x = before;
    x[1] *= 1.0 + 1e-13 * k;
    functions.limit(x.data(), par, image.data());
    for (std::size_t i = 0; i < image.size(); ++i) {
      INFO(k << ": state " << i);
      REQUIRE(std::abs(image[i] - known[i]) < 1e-9);
    }
    const double margin = functions.margin(x.data(), par);
    least = std::min(least, margin);
    largest = std::max(largest, margin);
  }
  CHECK(least < -1e-7);
  CHECK(largest > 1e-7);
}

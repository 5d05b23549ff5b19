// The derivative of the time until a ball rests on its table, against that of many impacts with 50 digits; the limit of
// a relief valve's impacts, whose flights have no closed form, against impacts one by one with 19 digits.
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <tchat/problem.hpp>
#include <vector>

#include "support/valve_flight.hpp"

using test_support::ValveFlight;

namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

/// A ball above a table that moves like Gamma sin t: height, velocity, and the table's two coordinates.
struct Ball {
  static constexpr int dimension = 4, parameters = 2, fields = 2, events = 3, jumps = 4;
  static constexpr tchat::Chatter chatter{
      .field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2, .limit = 3, .margin = 3, .leave = 4, .time = 0};
  template <class T>
  void field(int, const T* y, const T* par, T* f) const {
    const T growth = 1.0 - (y[2] * y[2] + y[3] * y[3]) / (par[0] * par[0]);
    f[0] = y[1];
    f[1] = T(-1.0);
    f[2] = growth * y[2] + y[3];
    f[3] = growth * y[3] - y[2];
  }
  template <class T>
  T event(int, const T* y, const T*) const {
    return y[0] - y[2];
  }
  template <class T>
  void jump(int k, const T* y, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = y[i];
    const T growth = 1.0 - (y[2] * y[2] + y[3] * y[3]) / (par[0] * par[0]);
    if (k == 1) g[1] = (1.0 + par[1]) * (growth * y[2] + y[3]) - par[1] * y[1];
  }
};

/// Derivatives by the time t and the velocity V before the first impact, by Gamma and by r.
using Gradient = std::array<Real, 4>;

/// By the first `count` flights, how long they take.
Gradient derivatives_of_time(double t0, double V0, double gamma0, double r0, int count) {
  const Real gamma = gamma0, r = r0;
  Real t = t0, V = V0, total = 0;
  Gradient of_t{1, 0, 0, 0}, of_V{0, 1, 0, 0}, of_total{};
  for (int k = 0; k < count; ++k) {
    const Real after = (1 + r) * gamma * cos(t) - r * V, rate = after - gamma * cos(t);
    Gradient of_after;
    for (std::size_t i = 0; i < 4; ++i)
      of_after[i] = (1 + r) * ((i == 2 ? cos(t) : Real(0)) - gamma * sin(t) * of_t[i]) +
                    (i == 3 ? Real(gamma * cos(t) - V) : Real(0)) - r * of_V[i];
    Real s = 2 * rate / (1 - gamma * sin(t));
    for (int n = 0; n < 60; ++n) {
      const Real h = gamma * sin(t) + after * s - s * s / 2 - gamma * sin(t + s);
      const Real change = h / (after - s - gamma * cos(t + s));
      s -= change;
      if (abs(change) < 1e-46 * abs(s)) break;
    }
    const Real by_s = after - s - gamma * cos(t + s);
    for (std::size_t i = 0; i < 4; ++i) {
      const Real of_h =
          gamma * (cos(t) - cos(t + s)) * of_t[i] + s * of_after[i] + (i == 2 ? Real(sin(t) - sin(t + s)) : Real(0));
      const Real of_s = -of_h / by_s;
      of_total[i] += of_s;
      of_t[i] += of_s;
      of_V[i] = of_after[i] - of_s;
    }
    total += s;
    t += s;
    V = after - s;
  }
  return of_total;
}

std::array<double, 4> derivatives_of_limit(double t0, double V0, double gamma0, double r0) {
  using Dual = tchat::Dual<4>;
  Dual t(t0), V(V0), gamma(gamma0), r(r0);
  Dual* const seeds[] = {&t, &V, &gamma, &r};
  for (std::size_t i = 0; i < 4; ++i) seeds[i]->derivative[i] = 1.0;
  const Dual sine = gamma * sin(t), cosine = gamma * cos(t);
  const std::array<Dual, 4> x{sine, V, sine, cosine};
  const std::array<Dual, 2> par{gamma, r};
  const Ball ball;
  return tchat::ChatterFunctions<Ball>(ball, Ball::chatter).rest(x.data(), par.data()).time.derivative;
}

/// A relief valve: lift, speed, pressure (C. J. Hos, A. R. Champneys, Physica D 241 (2012) 2068-2076).
struct Valve {
  static constexpr int dimension = 3, parameters = 2, fields = 2, events = 3, jumps = 4;
  static constexpr tchat::Chatter chatter{
      .field = 1, .event = 1, .impact = 1, .contact = 2, .release = 2, .limit = 3, .margin = 3, .leave = 4, .time = 0};
  template <class T>
  void field(int, const T* y, const T* par, T* f) const {
    f[0] = y[1];
    f[1] = -1.25 * y[1] - (y[0] + 10.0) + y[2];
    f[2] = 20.0 * (par[0] - y[0] * sqrt(y[2]));
  }
  template <class T>
  T event(int, const T* y, const T*) const {
    return y[0];
  }
  template <class T>
  void jump(int k, const T* y, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = y[i];
    if (k == 1) g[1] = -par[1] * y[1];
  }
};

}  // namespace

TEST_CASE("impacts one by one have the derivative of chatter as their limit, which they approach geometrically") {
  const double r = GENERATE(0.3, 0.5, 0.8);
  const double gamma = 1.15, t = 2.2, V = gamma * std::cos(t) - 0.01;
  const std::array<double, 4> limit = derivatives_of_limit(t, V, gamma, r);
  const int apart = static_cast<int>(std::ceil(std::log(1e-3) / std::log(r)));
  std::vector<double> errors;
  for (const int turns : {1, 2, 3, 4, 5, 6}) {
    const Gradient sum = derivatives_of_time(t, V, gamma, r, turns * apart);
    double error = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
      error = std::max(error, std::abs(static_cast<double>(sum[i] - limit[i])) / (1.0 + std::abs(limit[i])));
    errors.push_back(error);
  }
  INFO("r = " << r << ": " << errors[0] << ", " << errors[1] << ", " << errors[2] << ", " << errors[5]);
  // Terms are like k r^k: over `apart` impacts they fall a thousandfold, but for the factor k.
  CHECK(errors[1] < 2.5e-3 * errors[0]);
  CHECK(errors[2] < 2e-3 * errors[1]);
  CHECK(errors[5] < 1e-11);
}

TEST_CASE("the time until a relief valve rests on its seat, and its pressure then, are those of impacts one by one") {
  const std::array<double, 2> par{0.1, 0.5};
  const Valve valve;
  const tchat::ChatterFunctions<Valve> functions(valve, Valve::chatter);
  ValveFlight flight(par[0], par[1]);
  double summed = -1.0, pressure = 0.0;
  for (int impact = 0; impact < 60; ++impact) {
    flight.fly();
    const std::array<double, 3> x{0.0, static_cast<double>(flight.speed), static_cast<double>(flight.pressure)};
    if (summed < 0.0 && functions.impacts_before_limit(x.data(), par.data()) == 0) {
      const auto rest = functions.rest(x.data(), par.data());
      summed = static_cast<double>(flight.time) + rest.time;
      pressure = rest.state[2];
    }
    flight.hit();
    if (flight.speed < 1e-13L) break;
  }
  CHECK(flight.speed < 1e-12L);
  CHECK(std::abs(summed - static_cast<double>(flight.time)) < 1e-11);
  CHECK(std::abs(pressure - static_cast<double>(flight.pressure)) < 1e-10);
  // Known to 14 decimals.
  CHECK(std::abs(summed - 2.00444172911702) < 1e-10);
  CHECK(std::abs(pressure - 8.38145480385528) < 1e-10);
}

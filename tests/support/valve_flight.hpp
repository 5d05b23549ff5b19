/// A relief valve, impact by impact.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace test_support {

/// A relief valve (problems/valve, kappa = 1.25, beta = 20, delta = 10) from where it opens on, by Taylor series with
/// 19 digits.
class ValveFlight {
 public:
  static constexpr std::size_t order = 24;
  using Number = long double;
  Number lift = 0, speed = 0, pressure = 10, time = 0;
  ValveFlight(double q, double r) : q_(q), r_(r) {}

  /// To the next impact. Where the flight begins the lift and its rates up to the third may be zero.
  void fly() {
    constexpr Number longest = 0.02L;
    constexpr int most_steps = 10000;
    for (int step_number = 0; step_number < most_steps; ++step_number) {
      expand();
      // A first root in this step, where the lift has risen before.
      const Number step = std::min(longest, flight_scale());
      if (at(y1_, step) < 0) {
        Number low = step / 1e6L, high = step;
        for (int k = 0; k < 90; ++k) ((low + high) / 2 * by_time((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
        advance(low);
        return;
      }
      advance(step);
    }
    speed = pressure = NAN;  // there is none
  }

  void hit() {
    lift = 0;
    speed *= -r_;
  }
  /// Does it come to rest on its seat before the pressure opens it again?
  static bool rests(double q, double r) {
    ValveFlight flight(q, r);
    Number last = 1e9L;
    do {
      const Number before = flight.time;
      flight.fly();
      if (!(flight.time - before < last)) return false;  // lifted before it could rest
      last = flight.time - before;
      flight.hit();
    } while (flight.speed > 1e-12L);
    return true;
  }

 private:
  using Series = std::array<Number, order + 1>;
  void expand() {
    Series root{};
    y1_ = y2_ = y3_ = {};
    y1_[0] = lift, y2_[0] = speed, y3_[0] = pressure, root[0] = std::sqrt(pressure);
    for (std::size_t k = 0; k < order; ++k) {
      const auto next = static_cast<Number>(k + 1);
      Number flow = 0, squares = 0;
      for (std::size_t i = 0; i <= k; ++i) flow += y1_[i] * root[k - i];
      y1_[k + 1] = y2_[k] / next;
      y2_[k + 1] = (-1.25L * y2_[k] - y1_[k] - (k == 0 ? 10 : 0) + y3_[k]) / next;
      y3_[k + 1] = 20 * ((k == 0 ? q_ : 0) - flow) / next;
      for (std::size_t i = 1; i <= k; ++i) squares += root[i] * root[k + 1 - i];
      root[k + 1] = (y3_[k + 1] - squares) / (2 * root[0]);
    }
  }
  static Number at(const Series& y, Number s) {
    Number value = 0;
    for (std::size_t k = order + 1; k-- > 0;) value = value * s + y[k];
    return value;
  }
  /// y1 / s, without its first coefficient where that is zero.
  Number by_time(Number s) const {
    Number value = 0;
    for (std::size_t k = order + 1; k-- > 1;) value = value * s + y1_[k];
    return value + y1_[0] / s;
  }
  /// Twice the time that the next impact is away if the acceleration stays: steps are short where flights are.
  Number flight_scale() const {
    const Number about = y1_[2] < 0 ? -y1_[1] / y1_[2] : 1;
    return y1_[0] == 0 && about > 0 ? 2 * about : 1;
  }
  void advance(Number s) {
    lift = at(y1_, s), speed = at(y2_, s), pressure = at(y3_, s);
    time += s;
  }

  Number q_, r_;
  Series y1_{}, y2_{}, y3_{};
};

}  // namespace test_support

/// A ball above a table that moves like Gamma sin t, impact by impact: flights are parabolas over a sine.
#pragma once

#include <cmath>

namespace test_support {

/// The impacts of a ball that the table leaves at sin(t) = 1 / Gamma, one after the other.
class BallImpacts {
 public:
  BallImpacts(double gamma, double r) : gamma_(gamma), r_(r), released_(std::asin(1.0 / gamma)), time_(released_) {
    velocity_ = gamma_ * std::cos(time_);
    // The first flight: h is zero to third order where it begins.
    const auto height = [this](long double s) {
      return 1.0L + velocity_ * s - s * s / 2 - gamma_ * std::sin(released_ + s);
    };
    long double s = 0.05L;
    while (height(s) > 0) s += 1e-3L;
    fly(zero(height, s - 1e-3L, s));
  }

  /// From a state before an impact on.
  BallImpacts(double gamma, double r, double time, double relative_velocity)
      : gamma_(gamma), r_(r), released_(time), time_(time), velocity_(gamma_ * std::cos(time_) + relative_velocity) {}

  long double time() const { return time_ - released_; }
  long double phase() const { return time_; }
  /// Of the ball, before the impact.
  long double velocity() const { return velocity_; }

  /// False where none comes soon.
  bool next() {
    velocity_ = (1.0L + r_) * gamma_ * std::cos(time_) - r_ * velocity_;
    const long double rate = velocity_ - gamma_ * std::cos(time_), acceleration = gamma_ * std::sin(time_) - 1.0L;
    const auto height_by_time = [&](long double s) { return rate - s / 2 - gamma_ * curved(s); };
    const bool is_short = acceleration < 0 && -2 * rate / acceleration < 1;
    const long double step = is_short ? -rate / (50 * acceleration) : 1e-3L;
    long double before = 0;
    for (long double s = step; s < 10; before = s, s += s < 1500 * step ? step : 1e-3L)
      if (height_by_time(s) <= 0) return fly(zero(height_by_time, before, s)), true;
    return false;
  }
  /// Until contact is near; negative where impacts come to an end before, or a flight is longer than the one before.
  static long double time_until_rest(BallImpacts impacts) {
    long double last = HUGE_VALL;
    while (impacts.relative_velocity() > 1e-13L) {
      const long double from = impacts.time();
      if (!impacts.next() || !(impacts.time() - from < last)) return -1;
      last = impacts.time() - from;
    }
    return impacts.time();
  }
  long double relative_velocity() const { return std::abs(velocity_ - gamma_ * std::cos(time_)); }

 private:
  template <class Function>
  static long double zero(const Function& f, long double low, long double high) {
    for (int k = 0; k < 80; ++k) {
      const long double middle = (low + high) / 2;
      (f(middle) > 0 ? low : high) = middle;
    }
    return low;
  }
  /// (sin(t + s) - sin t - s cos t) / s
  long double curved(long double s) const {
    const long double sine = std::sin(time_), cosine = std::cos(time_);
    if (s > 1e-3L) return (std::sin(time_ + s) - sine - s * cosine) / s;
    return s * (-sine / 2 + s * (-cosine / 6 + s * (sine / 24 + s * (cosine / 120 - s * sine / 720))));
  }
  void fly(long double s) {
    time_ += s;
    velocity_ -= s;
  }

  long double gamma_, r_, released_, time_, velocity_ = 0;
};

}  // namespace test_support

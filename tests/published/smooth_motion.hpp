/// Smooth motions followed for long, by a Runge-Kutta method of order 8 with equal steps: independent of tchat's
/// integrators and of its collocation.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cstddef>
#include <cstdint>

namespace test_support {

template <std::size_t n>
using MotionState = std::array<double, n>;

/// field(x, dxdt, t); event(x, t).
template <std::size_t n, class Field, class Event>
class SmoothMotion {
 public:
  SmoothMotion(Field field, Event event, const MotionState<n>& start, double step)
      : field_(field), event_(event), x_(start), step_(step) {}

  /// To the next fall of the event function through zero, of which the state is returned; the motion itself goes on
  /// with equal steps.
  MotionState<n> next_fall() {
    while (true) {
      const MotionState<n> before = x_;
      const double h = event_(x_, t_);
      x_ = after(before, step_);
      t_ += step_;
      if (h > 0.0 && !(event_(x_, t_) > 0.0)) return fall(before, t_ - step_, h);
    }
  }
  double time() const { return t_; }

 private:
  MotionState<n> after(const MotionState<n>& x, double step, double t) {
    MotionState<n> y = x;
    method_.do_step(field_, y, t, step);
    return y;
  }
  MotionState<n> after(const MotionState<n>& x, double step) { return after(x, step, t_); }
  MotionState<n> fall(const MotionState<n>& before, double t, double h) {
    std::uintmax_t iterations = 40;
    const double last = event_(x_, t_);
    if (last == 0.0) return x_;
    const auto at =
        boost::math::tools::toms748_solve([&](double s) { return event_(after(before, s, t), t + s); }, 0.0, step_, h,
                                          last, boost::math::tools::eps_tolerance<double>(50), iterations);
    return after(before, 0.5 * (at.first + at.second), t);
  }

  Field field_;
  Event event_;
  MotionState<n> x_;
  double t_ = 0.0;
  double step_;
  boost::numeric::odeint::runge_kutta_fehlberg78<MotionState<n>> method_;
};

/// The least value of a state at `count` falls of the event function, after `transient` of them.
template <std::size_t n, class Field, class Event>
double least_at_falls(SmoothMotion<n, Field, Event> motion, std::size_t state, int transient, int count) {
  for (int k = 0; k < transient; ++k) motion.next_fall();
  double least = motion.next_fall()[state];
  for (int k = 1; k < count; ++k) least = std::min(least, motion.next_fall()[state]);
  return least;
}

}  // namespace test_support

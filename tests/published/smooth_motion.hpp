/// Smooth motions followed for long, by a Runge-Kutta method of order 8 with equal steps: independent of tchat's
/// integrators and of its collocation.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "support/random_matrices.hpp"

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
  /// When that was.
  double time_of_fall() const { return fallen_; }

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
    fallen_ = t_;
    if (last == 0.0) return x_;
    const auto at =
        boost::math::tools::toms748_solve([&](double s) { return event_(after(before, s, t), t + s); }, 0.0, step_, h,
                                          last, boost::math::tools::eps_tolerance<double>(50), iterations);
    fallen_ = t + 0.5 * (at.first + at.second);
    return after(before, fallen_ - t, t);
  }

  Field field_;
  Event event_;
  MotionState<n> x_;
  double t_ = 0.0, fallen_ = 0.0;
  double step_;
  boost::numeric::odeint::runge_kutta_fehlberg78<MotionState<n>> method_;
};

/// The least value of a state over a torus, from its values at `count` falls of the event function after `transient` of
/// them: the minimum of a polynomial through those near the least one, over the phase of the forcing. The points alone
/// lie too far apart near resonances.
template <std::size_t n, class Field, class Event>
double least_at_falls(SmoothMotion<n, Field, Event> motion, std::size_t state, double omega, int transient, int count) {
  struct Point {
    double phase;
    MotionState<n> x;
    double away = 0.0;
  };
  for (int k = 0; k < transient; ++k) motion.next_fall();
  std::vector<Point> points;
  for (int k = 0; k < count; ++k) {
    const MotionState<n> x = motion.next_fall();
    points.push_back({omega * motion.time_of_fall(), x});
  }
  const Point least =
      *std::min_element(points.begin(), points.end(), [&](auto& a, auto& b) { return a.x[state] < b.x[state]; });
  for (Point& point : points) {
    point.phase = std::remainder(point.phase - least.phase, 2.0 * M_PI);
    point.away = point.phase * point.phase;
    for (std::size_t i = 0; i < n; ++i) point.away += (point.x[i] - least.x[i]) * (point.x[i] - least.x[i]);
  }
  std::sort(points.begin(), points.end(), [](auto& a, auto& b) { return a.away < b.away; });
  points.resize(std::min<std::size_t>(points.size(), 20));

  constexpr int degree = 4;
  const double width = std::sqrt(points.back().away);
  Eigen::MatrixXd powers(points.size(), degree + 1);
  Eigen::VectorXd values(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    for (int d = 0; d <= degree; ++d) powers(row, d) = std::pow(points[k].phase / width, d);
    values(row) = points[k].x[state];
  }
  const Eigen::VectorXd c = tchat::test::closest_solution(powers, values);
  double t = 0.0;
  for (int k = 0; k < 20; ++k)
    t -= (c(1) + t * (2.0 * c(2) + t * (3.0 * c(3) + 4.0 * t * c(4)))) /
         (2.0 * c(2) + t * (6.0 * c(3) + 12.0 * t * c(4)));
  return c(0) + t * (c(1) + t * (c(2) + t * (c(3) + t * c(4))));
}

}  // namespace test_support

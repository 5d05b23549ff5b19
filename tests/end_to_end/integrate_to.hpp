/// Integration by the method of Runge, Kutta and Fehlberg of order 7(8), apart from tchat's own.
#pragma once

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>
#include <cstdint>

namespace test_support {

/// The state and the time where `event` falls to zero.
template <class State, class Field, class Event>
double integrate_to(State& x, const Field& field, const Event& event) {
  namespace odeint = boost::numeric::odeint;
  odeint::runge_kutta_fehlberg78<State> stepper;
  constexpr double h = 1e-3;
  const auto moved = [&](double step) {
    State y = x;
    stepper.do_step(field, y, 0.0, step);
    return y;
  };
  double time = 0.0;
  for (;;) {
    const State next = moved(h);
    if (event(x) > 0.0 && event(next) <= 0.0) break;
    x = next;
    time += h;
  }
  std::uintmax_t iterations = 60;
  const auto root = boost::math::tools::toms748_solve([&](double step) { return event(moved(step)); }, 0.0, h,
                                                      boost::math::tools::eps_tolerance<double>(50), iterations);
  x = moved(root.second);
  return time + root.second;
}

}  // namespace test_support

// A chain of five masses beside a stop, as problems/beam_stop/Makefile runs it, in closed form.
//
// Mode i of the chain, fixed at one end, has the frequency w_i = 2 sin((2 i - 1) pi / (2 (2 N + 1))), and the last mass
// has the part p_i = 2 sin((2 i - 1) N pi / (2 N + 1)) / sqrt(2 N + 1) in it. An impulse J on the last mass once a
// period T moves it by J G(t) with G = sum_i p_i^2 cos(w_i (t - T/2)) / (2 w_i sin(w_i T/2)), 0 <= t <= T. An impact
// without loss is an impulse 2 v, where v is the velocity after it, and there the other impulses give no velocity. One
// impact a period: v = 1 / sum_i p_i^2 cot(w_i T/2) / w_i.
#include <Eigen/Dense>
#include <boost/math/tools/toms748_solve.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "published/exponential_flow.hpp"
#include "published/makefile_run.hpp"
#include "published/newton.hpp"
#include "published/smooth_motion.hpp"

using namespace test_support;

namespace {

constexpr double pi = std::numbers::pi;
constexpr int masses = 5;
constexpr std::size_t states = 2 * masses;

double frequency(int i) { return 2.0 * std::sin((2 * i - 1) * pi / (2.0 * (2 * masses + 1))); }
/// Of mass k in mode i, from 1.
double part(int i, int k) {
  return 2.0 * std::sin((2 * i - 1) * k * pi / (2.0 * masses + 1)) / std::sqrt(2.0 * masses + 1);
}
double part(int i) { return part(i, masses); }

/// G and its derivatives in t.
double response(double t, double period, int derivative = 0) {
  double sum = 0.0;
  for (int i = 1; i <= masses; ++i) {
    const double w = frequency(i);
    sum += part(i) * part(i) * std::pow(w, derivative) * std::cos(w * (t - 0.5 * period) + 0.5 * pi * derivative) /
           (2.0 * w * std::sin(0.5 * w * period));
  }
  return sum;
}

/// After the impact of a contact mode; negative.
double impact_velocity(double period) { return 0.5 / response(0.0, period); }

/// Positions and velocities of all masses at the time t after the impact of a contact mode.
Eigen::VectorXd contact_mode(double t, double period) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(states);
  for (int i = 1; i <= masses; ++i) {
    const double w = frequency(i), size = part(i) * impact_velocity(period) / (w * std::sin(0.5 * w * period));
    for (int k = 1; k <= masses; ++k) {
      x(k - 1) += part(i, k) * size * std::cos(w * (t - 0.5 * period));
      x(masses + k - 1) -= part(i, k) * size * w * std::sin(w * (t - 0.5 * period));
    }
  }
  return x;
}

double stretch(const Eigen::VectorXd& x, Eigen::Index k) { return k > 0 ? x(k) - x(k - 1) : x(k); }
double energy(const Eigen::VectorXd& x) {
  double sum = 0.5 * x.tail(masses).squaredNorm();
  for (Eigen::Index k = 0; k < masses; ++k) sum += 0.5 * stretch(x.head(masses), k) * stretch(x.head(masses), k);
  return sum;
}
double energy(double period) { return energy(contact_mode(0.0, period)); }

/// det(1 + monodromy matrix) of a contact mode: the flow, then the impact with its saltation matrix.
double doubling(double period) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(states, states);
  A.topRightCorner(masses, masses).setIdentity();
  for (int k = 0; k < masses; ++k) {
    A(masses + k, k) = k + 1 < masses ? -2.0 : -1.0;
    if (k > 0) A(masses + k, k - 1) = A(masses + k - 1, k) = 1.0;
  }
  Eigen::MatrixXd flow(states, states);
  const AffineFlow motion(A, Eigen::VectorXd::Zero(states));
  for (int k = 0; k < flow.cols(); ++k) flow.col(k) = motion.after(period, Eigen::VectorXd::Unit(states, k));
  const Eigen::VectorXd before = contact_mode(period, period), after = contact_mode(0.0, period);
  Eigen::MatrixXd saltation = Eigen::MatrixXd::Identity(states, states);
  saltation(states - 1, states - 1) = -1.0;
  saltation.col(masses - 1) += (A * after - saltation * A * before) / before(states - 1);
  return tchat::test::determinant(Eigen::MatrixXd::Identity(states, states) + saltation * flow);
}

template <class Function>
double root(double below, double above, const Function& function) {
  std::uintmax_t iterations = 60;
  const auto at = boost::math::tools::toms748_solve(function, below, above,
                                                    boost::math::tools::eps_tolerance<double>(50), iterations);
  return 0.5 * (at.first + at.second);
}

double value(const PointSection& section, const PointRow& row, const char* name) {
  return row.values[section.column(name)];
}

/// An orbit with several impacts: its durations and velocities meet the equations of the impulses.
void check_impulses(const SolutionEntry& orbit) {
  const std::size_t impacts = orbit.states.front().size() / states;
  std::vector<double> times{0.0}, velocities;
  for (std::size_t j = 0; j < impacts; ++j) {
    velocities.push_back(orbit.states.front()[states * j + states - 1]);
    times.push_back(times.back() + orbit.parameter(61 + static_cast<int>(j)));
  }
  const double period = times.back();
  for (std::size_t j = 0; j < impacts; ++j) {
    double position = 0.0, velocity = 0.0;
    for (std::size_t k = 0; k < impacts; ++k) {
      const double since = times[j] - times[k], t = since < 0.0 ? since + period : since;
      position += 2.0 * velocities[k] * response(t, period);
      if (k != j) velocity += 2.0 * velocities[k] * response(t, period, 1);
    }
    check_near(position, 1.0, 1e-8);
    check_near(velocity, 0.0, 1e-8);
  }
}

}  // namespace

TEST_CASE("make -j2 in problems/beam_stop: modes, first touch and contact modes in closed form") {
  const MakefileRun chain("beam_stop", "branches");
  chain.check_verified();
  for (const int mode : {1, 2}) {
    const std::string name = std::to_string(mode);
    const double w = frequency(mode);
    const PointSection linear = chain.points("mode" + name).front();
    for (const PointRow& row : linear.rows) check_near(value(linear, row, "period"), 2.0 * pi / w, 1e-8);
    check_near(value(linear, linear.rows.back(), "energy"), 0.5 * std::pow(w / part(mode), 2));

    // resegment has chosen the side with the impact.
    CHECK(chain.read("d.contact" + name).find("inadmissible") == std::string::npos);
    const PointSection section = chain.points("contact" + name).front();
    REQUIRE(section.rows.size() > 15);
    for (const PointRow& row : section.rows) {
      const double period = value(section, row, "period"), velocity = impact_velocity(period);
      CAPTURE(name, period, velocity);
      if (std::abs(velocity) < 1e-3) continue;  // at the touch itself, where G is infinite
      // EPSU is 1e-10, and the mesh's error 1e-9 in the mode of highest frequency.
      CHECK(std::abs(value(section, row, "start(v5)") - velocity) < 1e-8 * (1.0 + std::abs(velocity)));
      // Near the second touch of mode 1 the energy changes by 40 for a period of 1.
      CHECK(value(section, row, "energy") == Approx(energy(period)).epsilon(1e-7));
    }
  }
}

TEST_CASE("beam_stop: fold, period doublings and the second touch of contact modes") {
  const MakefileRun chain("beam_stop", "q.contact1 q.three q.doubled");
  const auto slope = [](double period) { return (energy(period + 1e-5) - energy(period - 1e-5)) / 2e-5; };
  check_near(chain.only("contact1", "LP").parameter(61), root(21.6, 21.7, slope), 1e-7);
  std::size_t n = 0;
  for (const double near : {21.4175, 21.3182, 21.1927, 21.1068, 20.4187})
    check_near(chain.solution("contact1", "PD", ++n).parameter(61), root(near - 2e-3, near + 2e-3, doubling), 1e-7);
  CHECK(of_type(chain.diagnostics("contact1"), "PD").size() == n);
  // Steps that go from one doubling beyond the next find the same ones.
  chain.run("-c touch1 -s touch1 -o coarse DSMAX=0.3");
  REQUIRE(of_type(chain.diagnostics("coarse"), "PD").size() == n);
  for (std::size_t k = 1; k <= n; ++k)
    check_near(chain.solution("coarse", "PD", k).parameter(61), chain.solution("contact1", "PD", k).parameter(61),
               1e-6);
  check_near(chain.only("contact2", "PD").parameter(61), root(7.49, 7.4925, doubling), 1e-7);
  // The doubled orbit has two equal impacts, at a zero of G' that leaves half its period: there G'' is zero too.
  check_near(chain.only("contact2", "PD").parameter(61),
             0.5 * root(14.98, 14.985, [](double whole) { return response(0.5 * whole, whole, 2); }), 1e-7);

  for (const char* name : {"contact1", "contact2"}) {
    const SolutionEntry touch = chain.only(name, "GR");
    const double period = touch.parameter(61);
    const double share = touch.internal.at(3) > 0.5 ? 1.0 - touch.internal.at(3) : touch.internal.at(3);
    const Eigen::VectorXd exact =
        newton(Eigen::Vector2d(std::round(share * period * 1e3) / 1e3, period), 1e-10, [](const Eigen::VectorXd& y) {
          const Eigen::VectorXd x = contact_mode(y(0), y(1));
          return Eigen::VectorXd(Eigen::Vector2d(x(masses - 1) - 1.0, x(states - 1)));
        });
    check_near(period, exact(1), 1e-7);
  }
  for (const char* name : {"three", "doubled"})
    for (const SolutionEntry& orbit : chain.solutions(name)) check_impulses(orbit);
}

TEST_CASE("beam_stop: damping and drive that keep the energy of a contact mode") {
  const MakefileRun chain("beam_stop", "q.driven");
  // Work over a period of the conservative orbit: d sum (rate of a spring)^2 = f (1 - u_N^2) u_N'^2.
  double lost = 0.0, gained = 0.0;
  constexpr int points = 20000;  // of the midpoint rule, whose error is 1e-8 of the sums
  constexpr double period = 20.8;
  for (int k = 0; k < points; ++k) {
    const Eigen::VectorXd x = contact_mode((k + 0.5) * period / points, period);
    for (Eigen::Index i = 0; i < masses; ++i) lost += std::pow(stretch(x.tail(masses), i), 2);
    gained += (1.0 - x(masses - 1) * x(masses - 1)) * x(states - 1) * x(states - 1);
  }
  const PointSection section = chain.points("damped").front();
  // f / d is even in d, for the conservative chain is reversible: from two points to d = 0.
  const auto ratio = [&](std::size_t k) {
    const double d = value(section, section.rows[k], "d");
    return std::pair(d * d, value(section, section.rows[k], "f") / d);
  };
  const auto [d1, ratio1] = ratio(1);
  const auto [d2, ratio2] = ratio(2);
  CAPTURE(d1, ratio1, d2, ratio2);
  CHECK((ratio1 * d2 - ratio2 * d1) / (d2 - d1) == Approx(lost / gained).epsilon(1e-8));
  for (const PointRow& row : section.rows) check_near(value(section, row, "energy"), energy(period), 1e-8);

  // The orbit with d = 0.01 by an integrator of order 8.
  const SolutionEntry orbit = chain.only("damped", "UZ");
  const double d = orbit.parameter(1), f = orbit.parameter(2);
  check_near(d, 0.01);
  const auto field = [&](const MotionState<states>& x, MotionState<states>& dx, double) {
    const auto force = [&](std::size_t k) {
      return k > 0 ? x[k] - x[k - 1] + d * (x[masses + k] - x[masses + k - 1]) : x[k] + d * x[masses + k];
    };
    for (std::size_t k = 0; k < masses; ++k) {
      dx[k] = x[masses + k];
      dx[masses + k] = (k + 1 < masses ? force(k + 1) : 0.0) - force(k);
    }
    dx[states - 1] += f * (1.0 - x[masses - 1] * x[masses - 1]) * x[states - 1];
  };
  const auto stop = [](const MotionState<states>& x, double) { return 1.0 - x[masses - 1]; };
  MotionState<states> start{};
  std::copy_n(orbit.states.front().begin(), states, start.begin());
  SmoothMotion<states, decltype(field), decltype(stop)> motion(field, stop, start, 0.02);
  MotionState<states> end = motion.next_fall();
  end[states - 1] *= -1.0;
  check_near(motion.time_of_fall(), orbit.parameter(61));
  for (std::size_t k = 0; k < states; ++k) check_near(end[k], start[k]);
  CHECK(chain.point("damped", "UZ").point < 0);  // stable
}

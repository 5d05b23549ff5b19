#include <Eigen/Core>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <vector>

#include "../model/linear_oscillator.hpp"
#include "base/messages.hpp"
#include "motion/orbit_flow.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using Catch::Matchers::Contains;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tchat::test::VanDerPol;

namespace {

constexpr double pi = 3.14159265358979323846;

const HybridSystem& linosc() {
  static const HybridSystem system(*ProblemTable<LinearOscillator>::get("linosc"));
  return system;
}

VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

double distance(const VectorXd& a, const VectorXd& b) { return (a - b).lpNorm<Eigen::Infinity>(); }

/// x'' = -w^2 x with events at falling x1, falling x2, and x1 + 1000 that never comes.
struct Harmonic {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 3, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = -p[0] * p[0] * x[0];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return x[0];
    if (j == 2) return x[1];
    return x[0] + 1000.0;
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? x[1] : -0.5 * x[1];
  }
};

/// A ball over the ground: height, velocity; gravity p1, restitution p2. Field 2 cannot be evaluated above height 1.
struct Ball {
  static constexpr int dimension = 2, parameters = 2, fields = 2, events = 1, jumps = 1;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = i == 1 ? T(-p[0]) : sqrt(1.0 - x[0]);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0], g[1] = -p[1] * x[1];
  }
};

template <class Problem>
const HybridSystem& system_of() {
  static const HybridSystem system(*ProblemTable<Problem>::get("test problem"));
  return system;
}

}  // namespace

TEST_CASE("harmonic oscillator: flow, its Jacobian and its parameter derivative in closed form") {
  const double w = 1.7, t = 2.3, a = 0.6, b = -0.4;
  FlowOptions options;
  options.active = {1};
  for (const IntegrationMethod method : {IntegrationMethod::adams, IntegrationMethod::bdf}) {
    options.method = method;
    const SegmentFlow flow = integrate_for(system_of<Harmonic>(), 1, vector({a, b}), vector({w}), t, options);
    const double c = std::cos(w * t), s = std::sin(w * t);
    const double bound = method == IntegrationMethod::adams ? 1e-11 : 1e-9;
    CHECK(flow.status == FlowStatus::time_reached);
    CHECK(flow.duration == t);
    CHECK(distance(flow.end_state, vector({a * c + b * s / w, b * c - a * w * s})) < bound);
    MatrixXd phi(2, 2);
    phi << c, s / w, -w * s, c;
    CHECK((flow.jacobian - phi).lpNorm<Eigen::Infinity>() < bound);
    const VectorXd by_w = vector({-a * t * s + b * (t * c / w - s / (w * w)), -b * t * s - a * (s + w * t * c)});
    CHECK(distance(flow.parameter_derivative, by_w) < 10 * bound);
  }
}

TEST_CASE("harmonic oscillator: durations zero and negative, and without variational equations") {
  const VectorXd x = vector({0.6, -0.4}), par = vector({1.7});
  const SegmentFlow none = integrate_for(system_of<Harmonic>(), 1, x, par, 0.0);
  CHECK(none.end_state == x);
  CHECK(none.jacobian == MatrixXd::Identity(2, 2));
  FlowOptions plain;
  plain.variational = false;
  const SegmentFlow forth = integrate_for(system_of<Harmonic>(), 1, x, par, 3.0, plain);
  CHECK(forth.jacobian.size() == 0);
  const SegmentFlow back = integrate_for(system_of<Harmonic>(), 1, forth.end_state, par, -3.0);
  CHECK(distance(back.end_state, x) < 1e-11);
}

TEST_CASE("harmonic oscillator: events and starts on the event surface") {
  const double w = 1.7, quarter = pi / (2 * w);
  const VectorXd par = vector({w});
  const auto duration = [&](const IndexVector& index, const VectorXd& x) {
    const SegmentFlow flow = integrate_segment(system_of<Harmonic>(), index, x, par);
    CHECK(flow.status == FlowStatus::event_reached);
    return flow.duration;
  };
  CHECK(duration({1, 1, 1}, vector({1, 0})) == Approx(quarter).epsilon(1e-12));
  // x1 = 0 falling at the start: a whole period until it falls again, whatever rounding says about the start.
  for (const double h : {0.0, 1e-16, -1e-16, 1e-11, -1e-11})
    CHECK(duration({1, 1, 1}, vector({h, -1})) == Approx(4 * quarter).epsilon(1e-10));
  // x1 = 0 rising at the start: half a period.
  for (const double h : {0.0, 1e-16, -1e-16, 1e-11, -1e-11})
    CHECK(duration({1, 1, 1}, vector({h, 1})) == Approx(2 * quarter).epsilon(1e-10));
  // Starts clearly off the surface are not on it.
  CHECK(duration({1, 1, 1}, vector({1e-4, -1})) == Approx(std::asin(1e-4 * w / std::hypot(1, 1e-4 * w)) / w));
  CHECK(duration({1, 1, 1}, vector({-1, 0})) == Approx(3 * quarter).epsilon(1e-12));

  const SegmentFlow end = integrate_segment(system_of<Harmonic>(), {1, 1, 1}, vector({1, 0}), par);
  CHECK(end.event_velocity == Approx(-w).epsilon(1e-11));
}

TEST_CASE("harmonic oscillator: return map of two segments in closed form") {
  // From (a, 0): a quarter period to x1 = 0, velocity -w a; the jump makes it +w a / 2; a quarter period to the
  // maximum a / 2 of x1: x1 -> x1 / 2. The second segment ends in the identity jump.
  FlowOptions options;
  options.active = {1};
  const ReturnMap map =
      return_map(system_of<Harmonic>(), {{1, 1, 2}, {1, 2, 1}}, vector({0.8, 0}), vector({1.7}), options);
  REQUIRE(map.ok);
  CHECK(distance(map.end, vector({0.4, 0.0})) < 1e-11);
  CHECK(map.period == Approx(pi / 1.7).epsilon(1e-12));
  REQUIRE(map.segments.size() == 2);
  CHECK(map.segments[0].duration == Approx(pi / 3.4).epsilon(1e-12));
  CHECK(distance(map.segments[0].end, vector({0.0, -1.36})) < 1e-11);
  CHECK(distance(map.segments[1].start, vector({0.0, 0.68})) < 1e-11);
  CHECK(map.segments[1].event_velocity == Approx(-1.7 * 1.7 * 0.4).epsilon(1e-11));
  CHECK(std::abs(map.multipliers[0] - 0.5) < 1e-11);
  CHECK(std::abs(map.multipliers[1]) < 1e-11);
  CHECK(map.parameter_derivative.lpNorm<Eigen::Infinity>() < 1e-10);  // x1 / 2 whatever the frequency
}

TEST_CASE("a contact much shorter than a step is not missed") {
  // Event 3 is x1 + 1000 with x1 = 1000 (1 + depth) cos(w t): below zero only for a short time around w t = pi.
  const double w = 1.7;
  for (const double depth : {1e-3, 1e-6, 1e-9, 1e-11}) {
    const double amplitude = 1000.0 * (1.0 + depth);
    const SegmentFlow flow = integrate_segment(system_of<Harmonic>(), {1, 3, 1}, vector({amplitude, 0.0}), vector({w}));
    CHECK(flow.status == FlowStatus::event_reached);
    CHECK(flow.duration == Approx((pi - std::acos(1.0 / (1.0 + depth))) / w).epsilon(1e-6));
  }
  FlowOptions options;
  options.max_duration = 20.0;
  const SegmentFlow above =
      integrate_segment(system_of<Harmonic>(), {1, 3, 1}, vector({1000.0 * (1 - 1e-9), 0.0}), vector({w}), options);
  CHECK(above.status == FlowStatus::time_reached);
}

TEST_CASE("bouncing ball: return map and its parameter derivative in closed form") {
  // From (0, v): flight time 2 v / g, next velocity r v.
  FlowOptions options;
  options.active = {1, 2};
  const double v = 1.3, g = 9.81, r = 0.7;
  const ReturnMap map = return_map(system_of<Ball>(), {{1, 1, 1}}, vector({0, v}), vector({g, r}), options);
  REQUIRE(map.ok);
  CHECK(distance(map.end, vector({0, r * v})) < 1e-12);
  CHECK(map.period == Approx(2 * v / g).epsilon(1e-12));
  MatrixXd by_parameters(2, 2);
  by_parameters << 0, 0, 0, v;
  CHECK((map.parameter_derivative - by_parameters).lpNorm<Eigen::Infinity>() < 1e-11);
  CHECK(std::abs(map.multipliers[0] - r) < 1e-11);
}

TEST_CASE("van der Pol oscillator: period and multiplier agree between methods and tolerances") {
  // The period is compared between two methods and with the defining integral of the multiplier,
  // mu = exp(integral of the divergence), which shares only the orbit with the eigenvalues of M.
  ShootingOptions fine, coarse;
  coarse.flow.method = IntegrationMethod::bdf;
  coarse.flow.relative_tolerance = 1e-11;
  coarse.flow.absolute_tolerance = 1e-12;
  coarse.tolerance = 1e-9;
  const VectorXd guess = vector({2.0, 0.0}), par = vector({1.0});
  const PeriodicOrbit a = shoot(system_of<VanDerPol>(), {{1, 1, 1}}, guess, par, fine);
  const PeriodicOrbit b = shoot(system_of<VanDerPol>(), {{1, 1, 1}}, guess, par, coarse);
  REQUIRE(a.converged);
  REQUIRE(b.converged);
  CHECK(a.map.period == Approx(6.66328685933).epsilon(1e-11));
  CHECK(b.map.period == Approx(a.map.period).epsilon(1e-8));
  CHECK(a.start[0] == Approx(b.start[0]).epsilon(1e-8));

  // Simpson's rule on 400 pieces of the orbit for the integral of 1 - x1^2.
  const int pieces = 400;
  const double h = a.map.period / pieces;
  double integral = 0.0;
  VectorXd x = a.start;
  for (int k = 0; k <= pieces; ++k) {
    const double weight = k == 0 || k == pieces ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    integral += weight * (1.0 - x[0] * x[0]) * h / 3.0;
    x = integrate_for(system_of<VanDerPol>(), 1, x, par, h).end_state;
  }
  CHECK(std::abs(a.map.multipliers[0] - std::exp(integral)) < 1e-9);
  CHECK(std::abs(a.map.multipliers[1]) < 1e-12);
}

TEST_CASE("linosc: nonimpacting orbit of the published table") {
  const VectorXd guess = vector({0.99, 0.0, 0.07, -0.99}), par = vector({3.0, 2.0, 0.05, 0.8});
  ShootingOptions options;
  const PeriodicOrbit orbit = shoot(linosc(), {{1, 2, 2}}, guess, par, options);
  REQUIRE(orbit.converged);
  CHECK(distance(orbit.start, vector({0.997785157856609, 0.0, 0.066519010523774, -0.997785157856609})) < 1e-11);
  CHECK(orbit.map.period == Approx(pi).epsilon(1e-12));
  const auto& multipliers = orbit.map.multipliers;
  CHECK(std::abs(multipliers[0] - std::complex<double>(-0.85462940113096, 0.0033582392967611)) < 1e-10);
  CHECK(std::abs(multipliers[1] - std::complex<double>(-0.85462940113096, -0.0033582392967611)) < 1e-10);
  CHECK(std::abs(multipliers[2] - 0.001867442731708) < 1e-10);
  CHECK(std::abs(multipliers[3]) < 1e-12);

  // The same orbit from its minimum has the same multipliers.
  const PeriodicOrbit other = shoot(linosc(), {{1, 3, 2}}, -orbit.start, vector({3.0, 2.0, 0.05, 0.8}), options);
  REQUIRE(other.converged);
  CHECK(distance(other.start, vector({-0.997785157856609, 0.0, -0.066519010523774, 0.997785157856609})) < 1e-11);
  CHECK(std::abs(other.map.multipliers[0] - multipliers[0]) < 1e-10);
}

TEST_CASE("linosc: impacting orbits of the published table") {
  struct Row {
    double omega, v, alpha, y1, y2;
    std::complex<double> multipliers[2];
  };
  const std::vector<Row> rows = {
      {2.0072, 0.01, 3.03570284598397, 0.0669690800277, -0.997755051263, {-8.0013040443, -0.058488566665}},
      {2.0072,
       0.5,
       3.04852587939213,
       0.108128110009,
       -0.994136968343,
       {{0.5896957647, 0.34676174832}, {0.5896957647, -0.34676174832}}},
      {2.0072,
       5,
       3.39159789647371,
       0.439271830566,
       -0.898354194553,
       {{0.67454541497, 0.11390034304}, {0.67454541497, -0.11390034304}}},
      {1.8901, 1, 2.38541057447103, 0.175147630331, -0.984542181722, {2.0129136551, 0.22802581492}},
      {1.8901, 8, 2.16507472824774, 0.932680082374, -0.360704676908, {0.86018166947, 0.53360388028}},
  };
  for (const Row& row : rows) {
    CAPTURE(row.omega, row.v);
    const VectorXd par = vector({row.alpha, row.omega, 0.05, 0.8});
    const VectorXd start = vector({1.0, -0.8 * row.v, row.y1, row.y2});
    // A guess that is off, so that Newton has something to do, but not so far that it misses the wall: the excess over
    // it that the orbit would have without impact is about v^2 / 8.
    VectorXd guess = start;
    guess[1] *= 1.001;
    guess[2] += std::min(1e-4, 1e-2 * row.v * row.v);
    const PeriodicOrbit orbit = shoot(linosc(), {{1, 1, 1}}, guess, par);
    INFO(orbit.message);
    REQUIRE(orbit.converged);
    CHECK(orbit.iterations >= 1);
    CHECK(distance(orbit.start, start) < 2e-11);
    CHECK(orbit.map.segments[0].end[1] == Approx(row.v).epsilon(2e-10));
    CHECK(orbit.map.segments[0].event_velocity == Approx(-row.v).epsilon(2e-10));
    CHECK(orbit.map.period == Approx(2 * pi / row.omega).epsilon(1e-12));
    const double limit_cycle = std::exp(-2 * orbit.map.period);
    for (const std::complex<double>& expected :
         {row.multipliers[0], row.multipliers[1], std::complex<double>(limit_cycle), std::complex<double>(0.0)}) {
      double nearest = INFINITY;
      for (const std::complex<double>& found : orbit.map.multipliers)
        nearest = std::min(nearest, std::abs(found - expected));
      CHECK(nearest < 1e-9);
    }
  }
}

TEST_CASE("linosc: derivatives of the return map agree with differences of it") {
  const VectorXd par = vector({3.04852587939213, 2.0072, 0.05, 0.8});
  const VectorXd x = vector({1.0, -0.4, 0.108128110009, -0.994136968343});
  FlowOptions options;
  options.active = {1, 2, 3, 4};
  const Signature signature = {{1, 1, 1}, {1, 3, 2}, {1, 1, 1}};
  const ReturnMap map = return_map(linosc(), signature, x, par, options);
  REQUIRE(map.ok);
  MatrixXd product = MatrixXd::Identity(4, 4);
  for (const MapSegment& segment : map.segments) product = segment.map_derivative * product;
  const double step = 1e-5;
  for (int c = 0; c < 8; ++c) {
    const auto moved = [&](double by) {
      VectorXd xm = x, pm = par;
      (c < 4 ? xm[c] : pm[c - 4]) += by;
      return return_map(linosc(), signature, xm, pm, options).end;
    };
    if (c == 0) continue;  // off the wall the start would be an event itself
    const VectorXd difference = (moved(step) - moved(-step)) / (2 * step);
    const VectorXd column = c < 4 ? map.derivative.col(c) : map.parameter_derivative.col(c - 4);
    CHECK(distance(column, difference) < 1e-5 * (1 + column.norm()));
  }
}

TEST_CASE("what cannot be integrated is a value") {
  FlowOptions options;
  options.max_duration = 10.0;
  const VectorXd par = vector({1.0});
  const SegmentFlow never = integrate_segment(system_of<Harmonic>(), {1, 3, 1}, vector({1, 0}), par, options);
  CHECK(never.status == FlowStatus::time_reached);
  CHECK_THAT(never.message, Contains("event 3 did not fall to zero within time 10"));

  // Field 2 accelerates the ball into heights where its field is not defined.
  const SegmentFlow stuck = integrate_segment(system_of<Ball>(), {2, 1, 1}, vector({0.5, 1}), vector({1, 1}), options);
  CHECK(stuck.status == FlowStatus::failed);
  CHECK_THAT(stuck.message, Contains("field 2"));
  const SegmentFlow undefined = integrate_for(system_of<Ball>(), 2, vector({2.0, 1}), vector({1, 1}), 1.0);
  CHECK(undefined.status == FlowStatus::failed);

  const ReturnMap map = return_map(system_of<Harmonic>(), {{1, 1, 1}, {1, 3, 1}}, vector({1, 0}), par, options);
  CHECK_FALSE(map.ok);
  CHECK_THAT(map.message, Contains("segment 2"));

  const ReturnMap tangent = return_map(system_of<Ball>(), {{1, 1, 1}}, vector({0, 1}), vector({0, 1}), options);
  CHECK_FALSE(tangent.ok);

  options.max_steps = 3;
  const SegmentFlow few = integrate_segment(system_of<Harmonic>(), {1, 1, 1}, vector({1, 0}), par, options);
  CHECK(few.status == FlowStatus::failed);

  const PeriodicOrbit none = shoot(system_of<Ball>(), {{1, 1, 1}}, vector({0.0, 1}), vector({1, 1.0}), {});
  CHECK((none.converged || !none.message.empty()));
}

TEST_CASE("nonsense is refused") {
  const VectorXd x = vector({1, 0}), par = vector({1});
  const HybridSystem& system = system_of<Harmonic>();
  CHECK_THROWS_AS(integrate_segment(system, {2, 1, 1}, x, par), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {1, 4, 1}, x, par), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {0, 1, 1}, x, par), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {1, 1, 1}, vector({1}), par), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {1, 1, 1}, vector({1, NAN}), par), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {1, 1, 1}, x, VectorXd()), UserError);
  CHECK_THROWS_AS(integrate_segment(system, {1, 1, 1}, x, vector({INFINITY})), UserError);
  CHECK_THROWS_AS(integrate_for(system, 1, x, par, NAN), UserError);
  FlowOptions options;
  options.active = {61};
  CHECK_THROWS_AS(integrate_for(system, 1, x, par, 1.0, options), UserError);
  CHECK_THROWS_AS(return_map(system, {}, x, par), UserError);
  CHECK_THROWS_AS(return_map(system, {{1, 1, 3}}, x, par), UserError);
}

// Monitors: values against what they say, gradients against central differences, names and their mistakes.
#include "orbit/monitor.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Watched {
  static constexpr int dimension = 2, parameters = 2, fields = 2, events = 2, jumps = 1, user_values = 1;
  static constexpr const char* state_names[] = {"x", "v"};
  static constexpr const char* user_value_names[] = {"energy"};
  static constexpr const char* event_names[] = {"wall", "turn of x"};
  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    f[0] = x[1] * par[0];
    f[1] = (i == 1 ? sin(x[0]) : x[0] * x[1]) - par[1];
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    return j == 1 ? par[1] - x[0] * x[0] * x[1] : x[1] * exp(par[0] * x[0]);
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
  void user_value(const double* x, const double* par, double* out) const {
    out[0] = 0.5 * x[1] * x[1] + par[0] * std::cos(x[0]);
  }
};

const HybridSystem& hybrid() { return system_of<Watched>(); }

Orbit some_orbit() {
  const OrbitShape shape{2, 2, 4, 3};
  Orbit x{shape, {0.0, 0.2, 0.45, 0.8, 1.0}, Eigen::MatrixXd(2, shape.columns()), ParameterVector(ParameterLayout())};
  for (Eigen::Index k = 0; k < x.states.cols(); ++k) {
    const double t = 0.23 * static_cast<double>(k);
    x.states.col(k) << std::sin(t) + 0.1 * t, 0.8 * std::cos(1.3 * t + 0.4);
  }
  x.par(0) = 0.7, x.par(1) = 0.4;
  x.duration(0) = 0.9, x.duration(1) = 1.6;
  return x;
}

/// The gradient along a direction that moves everything, against a difference of the values.
void check_gradient(const std::string& name) {
  INFO(name);
  const PeriodicOrbitSystem system(hybrid(), {{1, 1, 1}, {2, 2, 1}}, {1, 2});
  const std::unique_ptr<Monitor> monitor = make_monitor(parse_monitor(hybrid(), name, "test"), system);
  const Orbit x = some_orbit();
  const CollocationRule rule(x.shape.collocation);
  OrbitVector row(x.shape, 2), direction(x.shape, 2);
  CHECK(monitor->gradient(x, rule, row) == Approx(monitor->value(x, rule)).epsilon(1e-14));
  for (Eigen::Index k = 0; k < direction.states.size(); ++k)
    direction.states.data()[k] = std::cos(0.7 * static_cast<double>(k));
  direction.durations << 0.6, -0.8;
  direction.globals << 1.1, -0.5;
  const auto at = [&](double step) {
    Orbit moved = x;
    advance(moved, step, direction, {1, 2});
    return monitor->value(moved, rule);
  };
  constexpr double h = 1e-4;  // fourth order; rounding 1e-16 / h
  const double difference = (8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12.0 * h);
  CHECK(dot(row, direction) == Approx(difference).epsilon(1e-8));
}

double value_of(const std::string& name) {
  const PeriodicOrbitSystem system(hybrid(), {{1, 1, 1}, {2, 2, 1}}, {1, 2});
  const Orbit x = some_orbit();
  return make_monitor(parse_monitor(hybrid(), name, "test"), system)->value(x, CollocationRule(x.shape.collocation));
}

}  // namespace

TEST_CASE("gradients of monitors") {
  for (const char* name : {"period", "velocity(1)", "velocity(2)", "start(x)", "start(v, 2)", "start(energy, 2)",
                           "end(wall, 1)", "end(energy)", "max(x)", "min(x, 1)", "max(v, 2)", "max(energy)", "min(h2)",
                           "mean(x)", "mean(energy, 2)", "integral(v)", "integral(h1, 1)"})
    check_gradient(name);
}

TEST_CASE("values of monitors") {
  const Orbit x = some_orbit();
  CHECK(value_of("period") == 2.5);
  CHECK(value_of("end(x)") == x.end(1)[0]);
  CHECK(value_of("start(v, 2)") == x.start(1)[1]);
  // An extremum between nodes is beyond all nodes.
  CHECK(value_of("max(x, 1)") >= x.states.row(0).head(13).maxCoeff());
  CHECK(value_of("min(v)") < x.states.row(1).minCoeff());
  CHECK(value_of("mean(x)") == Approx(value_of("integral(x)") / 2.5).epsilon(1e-14));
  CHECK(value_of("mean(U(1))") == value_of("mean(x)"));
  CHECK(value_of("mean( x , 2 )") == value_of("mean(x,2)"));
  CHECK(value_of("max(PVLS(1))") == value_of("max(energy)"));
}

TEST_CASE("the extremum between nodes is that of the polynomial") {
  // x = t (1 - t) on one interval of degree 2: its top is 1/4 at t = 1/2; shifted to lie between nodes.
  const PeriodicOrbitSystem system(hybrid(), {{1, 1, 1}}, {1, 2});
  Orbit x{{2, 1, 2, 2}, {0.0, 0.3, 1.0}, Eigen::MatrixXd::Zero(2, 5), ParameterVector(ParameterLayout())};
  x.duration(0) = 1.0;
  const std::vector<double> tau = x.node_times();
  for (Eigen::Index k = 0; k < 5; ++k) {
    const double t = tau[static_cast<std::size_t>(k)];
    x.states(0, k) = t * (1.0 - t);
  }
  const CollocationRule rule(2);
  CHECK(make_monitor(parse_monitor(hybrid(), "max(x)", "test"), system)->value(x, rule) == Approx(0.25).epsilon(1e-14));
  CHECK(make_monitor(parse_monitor(hybrid(), "mean(x)", "test"), system)->value(x, rule) ==
        Approx(1.0 / 6.0).epsilon(1e-14));
}

TEST_CASE("names that are no monitors") {
  const auto message = [](const std::string& name) {
    try {
      parse_monitor(hybrid(), name, "gc.x:3: ICP");
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  using Catch::Matchers::Contains;
  CHECK_THAT(message("average(x)"), Contains("gc.x:3: ICP: 'average(x)'") && Contains("mean(X)") && Contains("energy"));
  CHECK_THAT(message("max(y)"), Contains("'y' is no state") && Contains("x, v, energy, h1 to h2"));
  CHECK_THAT(message("max(x"), Contains("parenthesis"));
  CHECK_THAT(message("max()"), Contains("is no state"));
  CHECK_THAT(message("max(turn of x)"), Contains("write h2"));
  CHECK_THAT(message("velocity"), Contains("velocity(S)"));
  CHECK_THAT(message("velocity(0)"), Contains("count from 1"));
  CHECK_THAT(message("max(x, 1, 2)"), Contains("too many arguments"));
  CHECK_THAT(message("period(2)"), Contains("too many arguments"));
  CHECK_THAT(message("multiplier(-1)"), Contains("no multiplier"));
}

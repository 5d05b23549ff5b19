#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "motion/cvodes_flow.hpp"
#include "motion/watched_flow.hpp"
#include "support/van_der_pol.hpp"

using namespace tchat;
using namespace tchat::test;

// The Newton steps to an event repeat the method's step from one start with other lengths: each with the field there.
TEST_CASE("Runge-Kutta flows come to their events as accurately as they are integrated") {
  const HybridSystem& system = system_of<VanDerPol>();
  Eigen::VectorXd par = Eigen::VectorXd::Zero(512);
  par(0) = 1.5;
  FlowOptions options;
  options.variational = false;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    Eigen::VectorXd x = Eigen::Vector2d(1.0, 0.5), exact = x;
    for (int turn = 0; turn < 5; ++turn) {
      FlowOptions loose = options;
      loose.method = IntegrationMethod::runge_kutta;
      loose.relative_tolerance = tolerance;
      loose.absolute_tolerance = 0.01 * tolerance;
      RungeKuttaFlow flow(system, 1, x, par, loose);
      flow.watch({1});
      REQUIRE(flow.advance(100.0) == Progress::root);
      CvodesFlow reference(system, 1, exact, par, options);
      reference.watch({1});
      REQUIRE(reference.advance(100.0) == Progress::root);
      x = flow.state(), exact = reference.state();
      // A step's error is the tolerance; some tens of steps a turn, on a cycle that attracts.
      CHECK((x - exact).norm() < 50.0 * tolerance);
      CHECK(std::abs(flow.time() - reference.time()) < 500.0 * tolerance);
    }
  }
}

namespace {

/// A clock, and an event function that turns much faster than it: cos(w t) - p.
struct FastEvent {
  static constexpr int dimension = 1, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T*, const T*, T* out) const {
    out[0] = T(1.0);
  }
  template <class T>
  T event(int, const T* x, const T* par) const {
    return cos(par[0] * x[0]) - par[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* out) const {
    out[0] = x[0];
  }
};

}  // namespace

// The steps of the integration grow with every one, as a clock's flow is a straight line.
TEST_CASE("a fall is found where the event function changes much faster than the states") {
  const HybridSystem& system = system_of<FastEvent>();
  Eigen::VectorXd par = Eigen::VectorXd::Zero(512);
  FlowOptions options;
  options.variational = false;
  options.max_duration = 1e6;
  for (const IntegrationMethod method : {IntegrationMethod::runge_kutta, IntegrationMethod::adams})
    for (const double w : {1.0, 3.7, 50.0, 400.0})
      for (const double level : {-0.999, -0.9, 0.2, 0.9}) {
        CAPTURE(static_cast<int>(method), w, level);
        par.head(2) << w, level;
        options.method = method;
        const double after = 0.5 * (std::acos(-1.0) + std::acos(level)) / w;  // h is negative
        const auto flow = make_flow(system, 1, Eigen::VectorXd::Constant(1, after), par, options);
        flow->watch({1});
        for (int turn = 1; turn <= 40; ++turn) {
          REQUIRE(flow->advance(1e5) == Progress::root);
          CHECK(std::abs(flow->time() + after - (std::acos(level) + 2.0 * std::acos(-1.0) * turn) / w) < 1e-8);
        }
      }
}

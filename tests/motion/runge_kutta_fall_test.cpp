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

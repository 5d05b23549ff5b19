#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>

#include "base/messages.hpp"
#include "fvdp_torus.hpp"
#include "maps/torus_return.hpp"
#include "motion/orbit_flow.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

TEST_CASE("fvdp's smooth torus: mu*, x3* and the curve's second derivative, and the map that it makes", "[slow]") {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  const ParameterVector par = full_par({5.0, 0.1, 0.75, 1.505, 0.8, 2.9236851});
  const MatrixXd all = torus_points(par, 2, 10000);
  CurveSettings settings;
  settings.angles = {2};
  const FittedCurve fit = fit_invariant_curve(all.leftCols(4000), settings, "points");
  INFO("error " << fit.error << " rho " << fit.curve.rotation() << " harmonics " << fit.curve.harmonics());
  CHECK(fit.error < 1e-9);
  const CurveProjection projection(fit.curve, 2);
  // Largest x1 on the curve: where it is stationary in the phase.
  double phi = 0.0;
  for (int k = 0; k < 1000; ++k)
    if (fit.curve.at(k / 1000.0)(0) > fit.curve.at(phi)(0)) phi = k / 1000.0;
  for (int k = 0; k < 10; ++k) phi -= fit.curve.derivative(phi)(0) / fit.curve.derivative(phi, 2)(0);
  const VectorXd top = fit.curve.at(phi);
  CHECK(top(0) == Approx(2.4053817).margin(5e-8));
  CHECK(std::fmod(top(2) + 10.0 * M_PI, 2.0 * M_PI) == Approx(2.9236851).margin(5e-8));
  const double slope = fit.curve.derivative(phi)(2);
  CHECK(fit.curve.derivative(phi, 2)(0) / (slope * slope) == Approx(-1.0084856).margin(2e-6));

  const auto suspended = std::make_shared<SuspendedSystem>(system, std::vector<int>{1}, 1, 1);
  TorusSettings torus;
  torus.order = 2;
  torus.accuracy = 1e-5;
  const TorusReturn map(suspended, fit.curve, projection, par, suspended->least_distance(), torus);
  INFO("defect " << map.defect() << " interpolation " << map.interpolation_error());
  CHECK(map.defect() < 1e-8);
  CHECK_FALSE(map.depends_on_parameters());
  // 10^4 iterates beside the simulated torus: it is told to 1e-7 where each lies.
  VectorXd x = all.col(0);
  double worst = 0.0;
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    worst = std::max(worst, fit.curve.difference(x, all.col(k)).cwiseAbs().maxCoeff());
    x = map.image(x, par);
  }
  CHECK(worst < 1e-7);

  // Off the curve: against the flow, with the error of second and of third order; the derivative against differences.
  const VectorXd on_curve = map.on_curve(0.3);
  const auto flow = [&](const VectorXd& start) {
    FlowOptions options;
    options.variational = false;
    return integrate_segment(system, {1, 2, 2}, start, par, options).end_state;
  };
  const TorusReturn linear(suspended, fit.curve, projection, par, suspended->least_distance(), TorusSettings{});
  const auto error = [&](const TorusReturn& of, double distance) {
    VectorXd start = on_curve;
    start(0) += distance;  // along P: x2 = 0
    return fit.curve.difference(of.image(start, par), flow(start)).cwiseAbs().maxCoeff();
  };
  CHECK(error(linear, 0.02) / error(linear, 0.01) == Approx(4.0).epsilon(0.15));
  CHECK(error(map, 0.02) / error(map, 0.01) == Approx(8.0).epsilon(0.25));
  CHECK(error(map, 0.01) < 0.1 * error(linear, 0.01));
  VectorXd off = on_curve;
  off(0) += 0.01;
  for (const TorusReturn* of : {&linear, &map}) {
    const MatrixXd jacobian = of->derivative(off, par);
    for (Eigen::Index i = 0; i < 3; ++i) {
      VectorXd forward = off, backward = off;
      forward(i) += 1e-5, backward(i) -= 1e-5;
      const VectorXd difference = fit.curve.difference(of->image(forward, par), of->image(backward, par)) / 2e-5;
      CHECK((jacobian.col(i) - difference).cwiseAbs().maxCoeff() < 1e-6);
    }
  }

  ParameterVector elsewhere = par;
  elsewhere(2) = 0.7;
  CHECK_THROWS_WITH(TorusReturn(suspended, fit.curve, projection, elsewhere, suspended->least_distance(), {}),
                    Catch::Contains("does not take the invariant curve to itself") && Catch::Contains("PAR(k)=v"));
}

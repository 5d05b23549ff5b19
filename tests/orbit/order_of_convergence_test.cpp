// Order of convergence on closed forms of the linear oscillator: 2c at mesh points, c + 1 in between.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/random_matrices.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Errors {
  double at_mesh_points = 0.0;
  double between = 0.0;
};

Errors errors(const OscillatorOrbit& exact, const Signature& signature, int intervals, int c) {
  const double period = exact.constants.period();
  const Orbit closed = sampled_orbit({exact.piece(0, period)}, 4, intervals, c, exact.par());
  PeriodicOrbits orbits(linosc(), signature, 1, closed.shape);
  const Orbit x = orbits.corrected(closed).orbit;
  REQUIRE(orbits.result.converged());
  Errors result{mesh_point_distance(x, closed), 0.0};
  result.at_mesh_points = std::max(result.at_mesh_points, std::abs(x.duration(0) - period));
  const CollocationRule rule(c);
  Eigen::VectorXd basis(c + 1);
  for (int j = 0; j < intervals; ++j)
    for (int k = 1; k < 20; ++k) {
      rule.basis(k / 20.0, basis.data(), nullptr);
      const Eigen::VectorXd state = x.states.middleCols(j * c, c + 1) * basis;
      const double tau = (j + k / 20.0) / intervals;
      result.between = std::max(result.between, (state - exact.state(tau * period)).cwiseAbs().maxCoeff());
    }
  return result;
}

/// Slope of -log(error) against log(N).
double order(const std::vector<int>& intervals, const std::vector<double>& found) {
  Eigen::MatrixXd a(found.size(), 2);
  Eigen::VectorXd b(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    a.row(row) << 1.0, -std::log(static_cast<double>(intervals[i]));
    b(row) = std::log(found[i]);
  }
  return closest_solution(a, b)(1);
}

struct Series {
  int c;
  std::vector<int> intervals;  // fine enough to be asymptotic, coarse enough for errors above 1e-11
};

}  // namespace

TEST_CASE("order of convergence: 2c at mesh points, at least c + 1 in between") {
  const Series series =
      GENERATE(Series{2, {32, 64, 128, 256}}, Series{3, {16, 24, 32, 48, 64}}, Series{4, {12, 16, 20, 24}});
  const bool impacting = GENERATE(false, true);
  const OscillatorOrbit exact = impacting ? one_impact_orbit(1.8901, 1.0) : nonimpacting_orbit(2.0, 3.0);
  const Signature signature = impacting ? Signature{{1, 1, 1}} : Signature{{1, 2, 2}};
  std::vector<double> at_mesh_points, between;
  for (const int n : series.intervals) {
    const Errors e = errors(exact, signature, n, series.c);
    at_mesh_points.push_back(e.at_mesh_points);
    between.push_back(e.between);
    CAPTURE(series.c, impacting, n, e.at_mesh_points, e.between);
    CHECK(e.at_mesh_points > 1e-12);  // otherwise rounding is measured
  }
  CAPTURE(series.c, impacting, at_mesh_points, between);
  CHECK(order(series.intervals, at_mesh_points) == Approx(2 * series.c).margin(0.2));
  CHECK(order(series.intervals, between) > series.c + 1 - 0.2);
}

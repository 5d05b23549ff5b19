// Segments with meshes of their own: numbers of intervals, transfer, the way to a mesh in common and back, order of
// convergence, and accuracy beside that of one mesh in common, against integration.
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "orbit/mesh_adaptation.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/sharp_start.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

OrbitShape own_shape(int dimension, const std::vector<int>& counts, int collocation) {
  const auto m = static_cast<int>(counts.size());
  OrbitShape shape{dimension, m, std::accumulate(counts.begin(), counts.end(), 0) / m, collocation};
  shape.own = OwnIntervals(counts);
  return shape;
}

/// Uneven meshes, another one for each segment.
std::vector<double> uneven_meshes(const OrbitShape& shape) {
  std::vector<double> mesh = uniform_mesh(shape);
  for (int s = 0; s < shape.segments; ++s)
    for (int j = 1; j < shape.intervals_of(s); ++j) {
      double& tau = mesh[static_cast<std::size_t>(shape.first_mesh_point(s) + j)];
      tau = std::pow(tau, 1.0 + 0.4 * s);
    }
  return mesh;
}

double cubic(int s, double tau) { return 1.0 + s - tau + (4.0 + s) * tau * tau * tau; }

Orbit cubic_orbit(const OrbitShape& shape) {
  Orbit x{shape, shape.own ? uneven_meshes(shape) : uniform_mesh(shape),
          Eigen::MatrixXd(shape.dimension, shape.columns()), ParameterVector(ParameterLayout())};
  for (int s = 0; s < shape.segments; ++s)
    for (int k = 0; k < shape.nodes_of(s); ++k) x.node(s, k)[0] = cubic(s, x.tau(s, k));
  return x;
}

/// The largest error of durations and of the states at the ends of segments.
double error_of_ends(const Orbit& x, const PeriodicOrbit& exact) {
  double worst = 0.0;
  for (int s = 0; s < x.shape.segments; ++s) {
    const auto& segment = exact.map.segments[static_cast<std::size_t>(s)];
    worst = std::max(worst, std::abs(x.duration(s) - segment.duration));
    worst =
        std::max(worst, (Eigen::VectorXd::Map(x.start(s), x.shape.dimension) - segment.start).cwiseAbs().maxCoeff());
  }
  return worst;
}

/// Corrected on meshes adapted to it until they settle.
Orbit settled(PeriodicOrbits& orbits, const Orbit& start, int passes) {
  PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  MeshEquidistribution equidistribution;
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<double>& mesh =
        equidistribution.mesh(point.orbit, orbits.follower.condensed().rule(), start.shape.intervals);
    orbits.follower.change_mesh(point, equidistribution.shape(), mesh);
    REQUIRE(orbits.start(point).converged());
  }
  return point.orbit;
}

/// Slope of -log(error) against log(N) between the first and the last.
double order(const std::vector<int>& intervals, const std::vector<double>& errors) {
  return std::log(errors.front() / errors.back()) / std::log(static_cast<double>(intervals.back()) / intervals.front());
}

}  // namespace

TEST_CASE("the nodes and meshes of segments of different size") {
  const OrbitShape shape = own_shape(2, {3, 7, 2}, 4);
  CHECK(shape.columns() == 3 * (4 * 4 + 1));
  CHECK(shape.total_intervals() == 12);
  CHECK(shape.mesh_points() == 15);
  int node = 0, point = 0;
  for (int s = 0; s < 3; ++s) {
    CHECK(shape.first_node(s) == node);
    CHECK(shape.first_mesh_point(s) == point);
    node += shape.nodes_of(s);
    point += shape.intervals_of(s) + 1;
    CHECK(shape.last_node(s) == node - 1);
  }
  CHECK(node == shape.columns());
  CHECK(shape == own_shape(2, {3, 7, 2}, 4));
  CHECK_FALSE(shape == own_shape(2, {3, 6, 3}, 4));
  CHECK_FALSE(shape == shape.in_common());
  CHECK_FALSE(shape.in_common().with_own_meshes() == shape.in_common());
}

TEST_CASE("intervals are dealt out by need, a few to each segment, and none is lost") {
  std::vector<int> counts;
  deal_out(Eigen::Vector4d(1.0, 0.0, 3.0, 1e-9), 200, 4, counts);
  CHECK(std::accumulate(counts.begin(), counts.end(), 0) == 200);
  CHECK(counts == std::vector<int>{50, 4, 142, 4});
  deal_out(Eigen::Vector3d(1.0, 1.0, 1.0), 6, 4, counts);  // fewer than the least for each
  CHECK(counts == std::vector<int>{2, 2, 2});
  Eigen::VectorXd many(100);
  for (Eigen::Index s = 0; s < 100; ++s) many(s) = 1.0 / (1.0 + static_cast<double>(s));
  deal_out(many, 1999, 4, counts);
  CHECK(std::accumulate(counts.begin(), counts.end(), 0) == 1999);
  for (std::size_t s = 1; s < 100; ++s) CHECK(counts[s] <= counts[s - 1] + 1);
}

TEST_CASE("polynomials are transferred exactly between own meshes and one in common") {
  const OrbitShape a = own_shape(1, {3, 7, 2}, 3), b = own_shape(1, {5, 4, 6}, 4), c{1, 3, 5, 3};
  const Orbit shapes[] = {cubic_orbit(a), cubic_orbit(b), cubic_orbit(c)};
  for (const Orbit& from : shapes)
    for (const Orbit& to : shapes) {
      const MeshTransfer transfer(from.shape, from.mesh, to.shape, to.mesh, CollocationRule(from.shape.collocation));
      CHECK((transfer(from.states) - to.states).cwiseAbs().maxCoeff() < 1e-13);
    }
}

TEST_CASE("any piecewise polynomial on own meshes comes back from the mesh in common") {
  const int c = GENERATE(2, 4, 7);
  const OrbitShape own = GENERATE_COPY(own_shape(2, {31, 9}, c), own_shape(2, {4, 4, 160, 8}, c));
  CAPTURE(c, own.segments);
  const std::vector<double> own_mesh = uneven_meshes(own);
  Eigen::MatrixXd states(2, own.columns());
  for (Eigen::Index k = 0; k < states.cols(); ++k)
    states.col(k) << std::sin(1.7 * static_cast<double>(k)), std::cos(0.9 * static_cast<double>(k));
  const std::vector<double> mesh = mesh_in_common(own, own_mesh);
  OrbitShape common = own.in_common();
  common.intervals = static_cast<int>(mesh.size()) - 1;
  CHECK(common.intervals < 2 * own.total_intervals());
  const MeshTransfer transfer(own, own_mesh, common, mesh, CollocationRule(c));
  const Eigen::MatrixXd back = states_on_own_meshes(transfer(states), common, mesh, own, own_mesh);
  CHECK((back - states).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("segments that have the same mesh have it in common") {
  const OrbitShape shape{1, 3, 5, 4};
  const Orbit x = with_own_meshes(cubic_orbit(shape));
  CHECK(have_one_mesh(x.shape, x.mesh));
  CHECK(mesh_in_common(x.shape, x.mesh) == uniform_mesh(5));
  Orbit moved = x;
  moved.mesh[8] *= 1.01;
  CHECK_FALSE(have_one_mesh(moved.shape, moved.mesh));
}

TEST_CASE("order of convergence 2c at the ends of segments with 1 : 3 intervals") {
  const int c = GENERATE(2, 3);
  const std::vector<int> intervals = c == 2 ? std::vector<int>{12, 24, 48} : std::vector<int>{6, 12, 24};
  const double rate = 2.0;
  const PeriodicOrbit exact = SharpStart::orbit(rate);
  REQUIRE(exact.converged);
  std::vector<double> errors;
  for (const int n : intervals) {
    const Orbit sampled = SharpStart::sampled(exact, rate, 2 * n, c);
    const OrbitShape shape = own_shape(2, {n, 3 * n}, c);
    Orbit start{shape, uneven_meshes(shape), {}, sampled.par};
    start.states = MeshTransfer(sampled.shape, sampled.mesh, shape, start.mesh, CollocationRule(c))(sampled.states);
    PeriodicOrbits orbits(system_of<SharpStart>(), SharpStart::signature(), 1, shape);
    errors.push_back(error_of_ends(orbits.corrected(start).orbit, exact));
    REQUIRE(orbits.result.converged());
  }
  CAPTURE(c, errors);
  CHECK(errors.back() > 1e-12);  // otherwise rounding is measured
  CHECK(order(intervals, errors) == Approx(2 * c).margin(0.3));
}

TEST_CASE("a sharp segment beside smooth ones: own meshes are more accurate than one in common") {
  const double rate = 200.0;
  const PeriodicOrbit exact = SharpStart::orbit(rate);
  REQUIRE(exact.converged);
  const Orbit start = SharpStart::sampled(exact, rate, 20, 4);
  PeriodicOrbits in_common(system_of<SharpStart>(), SharpStart::signature(), 1, start.shape);
  PeriodicOrbits own(system_of<SharpStart>(), SharpStart::signature(), 1, start.shape.with_own_meshes());
  const Orbit x = settled(in_common, start, 6), y = settled(own, with_own_meshes(start), 6);
  CHECK(y.shape.total_intervals() == x.shape.total_intervals());
  CHECK(y.shape.intervals_of(0) > 2 * y.shape.intervals_of(1));
  const double error_in_common = error_of_ends(x, exact), error_on_own = error_of_ends(y, exact);
  CAPTURE(error_in_common, error_on_own, y.shape.intervals_of(0), y.shape.intervals_of(1));
  CHECK(error_on_own > 1e-13);
  CHECK(error_on_own < error_in_common / 8.0);
}

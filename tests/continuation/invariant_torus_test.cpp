// A torus in closed form (problems/torus): states, rotation number, normal multipliers; how the error falls with the
// harmonics and with the mesh; derivatives of the coupling.
#include <catch2/catch.hpp>
#include <cmath>

#include "../../problems/torus/torus.cpp"
#include "bvp/rotation.hpp"
#include "bvp/torus_system.hpp"
#include "continuation/path_follower.hpp"
#include "special_points/torus_contact_condition.hpp"
#include "stability/torus_multipliers.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const double golden = 0.5 * (1.0 + std::sqrt(5.0));
constexpr int omega = 1, wall = 3;  // PAR

double radius(double psi, double w) { return (1.0 + w * w) / (1.0 + w * w - std::cos(psi) - w * std::sin(psi)); }

/// The state at the time t after the crossing of the section at the phase psi of the forcing.
Eigen::Vector4d state_at(double psi, double t, double w) {
  const double now = psi + w * t;
  const double angle = pi + golden * t;
  return {radius(now, w) * std::cos(angle), radius(now, w) * std::sin(angle), std::sin(now), std::cos(now)};
}

struct Torus {
  Torus(int orbits, const OrbitShape& one_return, std::vector<int> free = {omega, rotation_parameter})
      : system(system_of<PlanarTorus>(), {{1, 1, 1}}, orbits, std::move(free)),
        shape{4, orbits, one_return.intervals, one_return.collocation},
        follower(system, shape, WeightedNorm::unit(4), {12, 12, 1e-12, 1e-12}, omega) {}

  /// The closed form, moved off by waves of this size.
  Orbit start(double w, double off) const {
    Orbit x{shape, uniform_mesh(shape.intervals), Eigen::MatrixXd(4, shape.columns()),
            ParameterVector::Zero(parameter_length)};
    x.par(0) = w, x.par(1) = golden, x.par(2) = 5.0;
    x.par(rotation_parameter - 1) = w / golden - std::floor(w / golden);
    for (int i = 0; i < shape.segments; ++i) {
      x.duration(i) = 2.0 * pi / golden;
      for (int k = 0; k < shape.nodes(); ++k) {
        x.states.col(i * shape.nodes() + k) = state_at(2.0 * pi * i / shape.segments, x.tau(k) * x.duration(i), w);
        x.states.col(i * shape.nodes() + k) *= 1.0 + off * std::sin(1.0 + i + 0.3 * k);
      }
    }
    return x;
  }
  PathPoint solved(double w, double off = 1e-3) {
    PathPoint point = follower.make_point(start(w, off));
    result = follower.start_at_fixed_parameter(point);
    return point;
  }
  /// Largest distance of the curve on the section from the closed form, at phases that are none of the N too.
  double error(const Orbit& x, double w) const {
    double largest = 0.0;
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector4d u = section_curve(system, x) * interpolation_weights(shape.segments, k / 200.0).transpose();
      largest = std::max(largest, (u - state_at(std::atan2(u(2), u(3)), 0.0, w)).cwiseAbs().maxCoeff());
    }
    return largest;
  }

  TorusSystem system;
  OrbitShape shape;
  PathFollower follower;
  NewtonResult result;
};

}  // namespace

TEST_CASE("torus: states and rotation number of the closed form, one phase for all") {
  Torus torus(41, {4, 1, 20, 5});
  const double w = 2.0;
  const PathPoint point = torus.solved(w);
  REQUIRE(torus.result.converged());
  // 0.236^20 of the harmonics, mesh of order 10.
  CHECK(std::abs(TorusSystem::rotation(point.orbit) - (w / golden - 1.0)) < 1e-9);
  CHECK(torus.error(point.orbit, w) < 1e-9);
  CHECK(mean_return_time(torus.system, point.orbit) == Approx(2.0 * pi / golden).epsilon(1e-11));
  const double first = std::atan2(point.orbit.start(0)[2], point.orbit.start(0)[3]);
  for (int i = 0; i < 41; ++i) {
    const double psi = std::atan2(point.orbit.start(i)[2], point.orbit.start(i)[3]);
    CHECK(std::abs(std::remainder(psi - first - 2.0 * pi * i / 41, 2.0 * pi)) < 1e-9);
  }
}

TEST_CASE("torus: normal multipliers of the closed form") {
  // r is attracting with rate 1, the forcing's oscillator with rate 2; 1 along the curve, 0 along the flow.
  Torus torus(31, {4, 1, 20, 4});
  const PathPoint point = torus.solved(2.0);
  REQUIRE(torus.follower.linearize_at(point));
  const FloquetMultipliers multipliers = torus_multipliers(torus.follower.condensed(), point.orbit);
  REQUIRE(multipliers.values.size() == 4);
  CHECK(multipliers.stable());
  CHECK(multipliers.structural < 1e-8);
  CHECK(multipliers.values[1].real() == Approx(std::exp(-2.0 * pi / golden)).epsilon(1e-6));
  CHECK(multipliers.values[2].real() == Approx(std::exp(-4.0 * pi / golden)).epsilon(1e-6));
  CHECK(multipliers.values[3] == 0.0);
}

TEST_CASE("torus: the error falls geometrically with the harmonics, as the closed form's do") {
  // 1 / (a - b cos), a = 1 + w^2, b^2 = 1 + w^2: the harmonics fall by (a - sqrt(a^2 - b^2)) / b, 0.414 for w = 1.
  const double w = 1.0;
  std::vector<double> errors;
  for (const int harmonics : {4, 8, 12, 16}) {
    Torus torus(2 * harmonics + 1, {4, 1, 20, 4});
    const PathPoint point = torus.solved(w, 1e-5);
    REQUIRE(torus.result.converged());
    errors.push_back(torus.error(point.orbit, w));
    CHECK(last_harmonics(torus.system, point.orbit) < 10.0 * errors.back());
    CHECK(last_harmonics(torus.system, point.orbit) > 0.1 * errors.back());
  }
  for (std::size_t k = 1; k < errors.size(); ++k)
    CHECK(std::pow(errors[k] / errors[k - 1], 0.25) == Approx(std::sqrt(2.0) - 1.0).epsilon(0.1));
}

TEST_CASE("torus: order 2 NCOL in NTST") {
  const double w = 2.0;
  for (const int collocation : {2, 3}) {
    std::vector<double> errors, rotations;
    for (const int intervals : {8, 16, 32}) {
      Torus torus(31, {4, 1, intervals, collocation});
      const PathPoint point = torus.solved(w, 1e-5);
      REQUIRE(torus.result.converged());
      errors.push_back(torus.error(point.orbit, w));
      rotations.push_back(std::abs(TorusSystem::rotation(point.orbit) - (w / golden - 1.0)));
    }
    INFO("NCOL = " << collocation << ": " << errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(std::log2(errors[1] / errors[2]) > 2.0 * collocation - 0.4);
    CHECK(std::log2(rotations[1] / rotations[2]) > 2.0 * collocation - 0.4);
  }
}

TEST_CASE("torus: rho fixed and two parameters free is the same torus") {
  Torus torus(31, {4, 1, 20, 5}, {omega, 2});
  Orbit start = torus.start(2.0, 1e-4);
  start.par(1) += 1e-3;  // Omega is found from rho
  PathPoint point = torus.follower.make_point(start);
  REQUIRE(torus.follower.start_at_fixed_parameter(point).converged());
  CHECK(point.orbit.par(1) == Approx(golden).epsilon(1e-10));
}

TEST_CASE("torus: another number of orbits is the same curve") {
  Torus torus(31, {4, 1, 10, 4});
  const PathPoint point = torus.solved(2.0);
  const Orbit more = resampled_torus(point.orbit, 31, 45);
  CHECK(more.shape.segments == 45);
  const Eigen::Vector4d u = section_curve(torus.system, point.orbit) * interpolation_weights(31, 7.0 / 45).transpose();
  CHECK((Eigen::Map<const Eigen::Vector4d>(more.start(7)) - u).norm() < 1e-13);
  const Orbit back = resampled_torus(more, 45, 31);
  CHECK((back.states - point.orbit.states).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((back.par - point.orbit.par).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("torus: the least value of an event function between the orbits, and its gradient") {
  Torus torus(31, {4, 1, 20, 4});
  const TorusSystem system(system_of<PlanarTorus>(), {{1, 1, 1}}, 31, {omega, rotation_parameter, wall});
  Orbit x = torus.start(2.0, 0.0);
  const double w = 2.0, largest = 1.0 / (1.0 - 1.0 / std::sqrt(1.0 + w * w));
  CondensedSystem condensed(system, torus.shape, 3);
  TorusContactCondition condition(system, torus.shape, 0, 2);
  REQUIRE(condition.evaluate(condensed, x));
  CHECK(condition.value() == Approx(5.0 - largest).epsilon(1e-9));
  CHECK(condition.contact().tau == Approx(0.5).epsilon(1e-6));
  // h = mu - x: the wall moves it by one, and moving every node of x by e moves it by - e.
  CHECK(condition.gradient().globals(2) == Approx(1.0));
  CHECK(condition.gradient().states.row(0).sum() == Approx(-1.0).epsilon(1e-9));
  x.states.row(0).array() += 1e-6;
  REQUIRE(condition.evaluate(condensed, x));
  CHECK(condition.value() - (5.0 - largest) == Approx(-1e-6).epsilon(1e-2));
}

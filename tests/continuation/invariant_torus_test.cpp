// A torus in closed form (problems/torus): states, rotation number, normal multipliers; how the error falls with the
// harmonics and with the mesh; derivatives of the coupling.
#include <catch2/catch.hpp>
#include <cmath>

#include "continuation/planar_torus.hpp"
#include "stability/floquet_multipliers.hpp"
#include "stability/torus_contact.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// The same torus with the phase of the forcing as an angle that goes on: it winds along the curve y = 0.
struct AngleTorus {
  static constexpr int dimension = 3, parameters = 3;
  static constexpr int fields = 1, events = 2, jumps = 1;
  static constexpr double initial_parameters[] = {1.0, 1.618033988749895, 5.0};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    const T growth = 1.0 + sqrt(u[0] * u[0] + u[1] * u[1]) * (cos(u[2]) - 1.0);
    f[0] = -par[1] * u[1] + u[0] * growth;
    f[1] = par[1] * u[0] + u[1] * growth;
    f[2] = par[0];
  }
  template <class T>
  T event(int j, const T* u, const T* par) const {
    if (j == 1) return u[1];
    return par[2] - u[0];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = u[i];
  }
};

/// Its N orbits in closed form, moved off by waves of this size.
Orbit angle_torus(int orbits, int intervals, int collocation, double w, double off) {
  const OrbitShape shape{3, orbits, intervals, collocation};
  Orbit x{shape, uniform_mesh(intervals), Eigen::MatrixXd(3, shape.columns()), ParameterVector(ParameterLayout())};
  x.par(0) = w, x.par(1) = golden, x.par(2) = 5.0;
  x.par.rotation() = w / golden - std::floor(w / golden);
  for (int i = 0; i < orbits; ++i) {
    x.duration(i) = 2.0 * pi / golden;
    for (int k = 0; k < shape.nodes(); ++k) {
      const double psi = 2.0 * pi * i / orbits, t = x.tau(k) * x.duration(i);
      const Eigen::Vector4d planar = state_at(psi, t, w);
      x.states.col(i * shape.nodes() + k) << planar(0), planar(1), psi + w * t;
      x.states.col(i * shape.nodes() + k) *= 1.0 + off * std::sin(1.0 + i + 0.3 * k);
    }
  }
  return x;
}

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
  const FloquetMultipliers multipliers = torus_multipliers(torus.system, torus.follower.condensed(), point.orbit);
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
  const TorusSystem system(system_of<PlanarTorus>(), {{1, 1, 1}}, 31, {omega, ParameterLayout().rotation(), wall});
  Orbit x = torus.start(2.0, 0.0);
  const double w = 2.0, largest = 1.0 / (1.0 - 1.0 / std::sqrt(1.0 + w * w));
  CondensedSystem condensed(system, torus.shape, {3});
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

TEST_CASE("torus: a state that is an angle winds along the curve, and a return ends a turn further") {
  const double w = 2.0;  // more than golden: a return takes the angle once round and rho further
  const HybridSystem& hybrid = system_of<AngleTorus>();
  const Orbit start = angle_torus(31, 20, 4, w, 1e-4);
  const TorusWinding winding = torus_winding(hybrid, {{1, 1, 1}}, start);
  CHECK(winding.curve.isApprox(Eigen::Vector3d(0.0, 0.0, 2.0 * pi)));
  CHECK(winding.returns.isApprox(Eigen::Vector3d(0.0, 0.0, 2.0 * pi)));
  // x and y are no angles, whatever they do.
  CHECK(angle_states(hybrid, {{1, 1, 1}}, start.states.leftCols(5), start.par) == std::vector<Eigen::Index>{2});
  // Nor are they where 2 pi of them is rounding; the angle is one after many turns, too.
  Eigen::MatrixXd large = start.states.leftCols(5);
  large.topRows(2) *= 1e11;
  large.row(2).array() += 2000.0 * pi;
  CHECK(angle_states(hybrid, {{1, 1, 1}}, large, start.par) == std::vector<Eigen::Index>{2});

  const TorusSystem system(hybrid, {{1, 1, 1}}, 31, {omega, ParameterLayout().rotation()}, winding);
  PathFollower follower(system, start.shape, WeightedNorm::unit(start.shape), {12, 12, 1e-12, 1e-12}, omega);
  PathPoint point = follower.make_point(start);
  REQUIRE(follower.start_at_fixed_parameter(point).converged());
  // 0.236^15 of the harmonics, mesh of order 8.
  CHECK(std::abs(TorusSystem::rotation(point.orbit) - (w / golden - 1.0)) < 1e-9);
  for (const double phi : {0.0, 0.123, 0.6, 0.987}) {
    const Orbit one = return_at(system, point.orbit, phi);
    const Eigen::Vector3d u = one.states.col(0);
    const Eigen::Vector4d exact = state_at(u(2), 0.0, w);
    CHECK((u.head<2>() - exact.head<2>()).norm() < 1e-8);
    CHECK((return_at(system, point.orbit, phi, 1).states.col(0) -
           (return_at(system, point.orbit, phi + 1e-5).states.col(0) -
            return_at(system, point.orbit, phi - 1e-5).states.col(0)) /
               2e-5)
              .norm() < 1e-6);
  }
  CHECK(last_harmonics(system, point.orbit) < 1e-8);
  const Orbit more = resampled_torus(point.orbit, 31, 45, winding.curve);
  const Orbit back = resampled_torus(more, 45, 31, winding.curve);
  CHECK((back.states - point.orbit.states).cwiseAbs().maxCoeff() < 1e-11);

  REQUIRE(follower.linearize_at(point));
  const FloquetMultipliers multipliers = torus_multipliers(system, follower.condensed(), point.orbit);
  REQUIRE(multipliers.values.size() == 3);
  CHECK(multipliers.structural < 1e-8);
  CHECK(multipliers.values[1].real() == Approx(std::exp(-2.0 * pi / golden)).epsilon(1e-6));
}

TEST_CASE("torus: where the wall is touched, in closed form, for few orbits and for many") {
  // Largest x: at the angle 0, half a return after the section, where cos psi + w sin psi is largest.
  const double w = 2.0;
  const double psi = std::atan(w) - w * pi / golden;
  std::vector<double> phases;
  for (const int orbits : {31, 61}) {
    Torus torus(orbits, {4, 1, 20, 5});
    const PathPoint point = torus.solved(w, 1e-5);
    REQUIRE(torus.result.converged());
    const TorusContactSearch search(torus.system, 0, 2);
    const auto contact = search.least(point.orbit, torus.follower.condensed().rule());
    REQUIRE(contact);
    const double first = std::atan2(point.orbit.start(0)[2], point.orbit.start(0)[3]);  // of the phase 0
    const double turns = (psi - first) / (2.0 * pi);
    CHECK(std::abs(std::remainder(contact->phi - turns, 1.0)) < 1e-8);
    CHECK(contact->tau == Approx(0.5).epsilon(1e-9));
    phases.push_back(std::remainder(contact->phi + first / (2.0 * pi), 1.0));

    // Followed from a place nearby it is the same.
    TorusContactFollower follower(torus.system, torus.shape, 0, 2);
    TorusContact followed = *contact;
    followed.phi += 0.2 / orbits;
    followed.tau -= 0.01;
    REQUIRE(follower.follow(point.orbit, torus.follower.condensed().rule(), followed));
    CHECK(std::abs(followed.phi - contact->phi) < 1e-8);
    CHECK(std::abs(followed.value - contact->value) < 1e-10);  // from another mesh point
  }
  CHECK(std::abs(phases[0] - phases[1]) < 1e-8);
}

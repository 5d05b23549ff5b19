// The reduced MEMS oscillator by shooting, against SPEC section 13.2.
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/orbit_flow.hpp"
#include "support/mems_oscillator.hpp"
#include "support/multiplier_sets.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::VectorXd;

namespace {

constexpr double pi = 3.14159265358979323846;

VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

double distance(const VectorXd& a, const VectorXd& b) { return (a - b).lpNorm<Eigen::Infinity>(); }

/// Largest multipliers first.
double multiplier(const PeriodicOrbit& orbit, int k) { return orbit.map.multipliers(k).real(); }

/// {J1, J7} with an impact at a phase of the forcing, known roughly: followed through one slip for a guess of x_1(0).
PeriodicOrbit impacting_orbit(double voltage, double impact_velocity, double phase) {
  const VectorXd par = vector({voltage, 0.8});
  const VectorXd impact = vector({0.0, 0.5, impact_velocity, std::sin(phase), std::cos(phase)});
  VectorXd after(5);
  mems().value(FunctionKind::jump, 1, impact.data(), par.data(), after.data());
  const SegmentFlow slip = integrate_segment(mems(), {2, 2, 2}, after, par);
  return shoot(mems(), mems_orbits::impacting, slip.end_state, par);
}

}  // namespace

TEST_CASE("mems: the nonimpacting orbit {J11} at omega = 0.8, V = 0.5641") {
  const VectorXd state = vector({0.0, 0.368732189736, 0.0, -0.027574562403, 0.999619749459});
  const PeriodicOrbit orbit = shoot(mems(), mems_orbits::nonimpacting, state, vector({0.5641, 0.8}));
  REQUIRE(orbit.converged);
  CHECK(distance(orbit.start, state) < 2e-12);
  CHECK(orbit.map.period == Approx(pi / 0.8).epsilon(1e-12));
  CHECK(multiplier(orbit, 0) == Approx(-1.00266478).epsilon(1e-8));
  CHECK(multiplier(orbit, 1) == Approx(-0.85236464).epsilon(1e-8));
  CHECK(multiplier(orbit, 2) == Approx(0.0003882032).epsilon(1e-6));
  CHECK(std::abs(orbit.map.multipliers(3)) < 1e-10);
  CHECK(std::abs(orbit.map.multipliers(4)) < 1e-10);
}

TEST_CASE("mems: grazing at omega = 0.8 and the maximum displacement of the nonimpacting orbit there") {
  const VectorXd contact = vector({0.0, 0.5, 0.0, -0.0225309885, 0.9997461451});
  const PeriodicOrbit orbit = shoot(mems(), mems_orbits::nonimpacting, contact, vector({0.597984349382, 0.8}));
  REQUIRE(orbit.converged);
  CHECK(distance(orbit.start, contact) < 1e-10);
}

// Without the fold and the secondary grazing of 13.2: shooting is singular there, and ends at the wrong contact.
TEST_CASE("mems: impacting orbits {J1, J7} at omega = 0.8") {
  struct Row {
    double voltage, impact_velocity, t1, t2, mu1, mu2, phase_guess;
  };
  const Row rows[] = {
      {0.61785728526, 0.05, 3.92211913811, 0.004871678877, -58.4767711, -0.00344065196, -0.06588},
      {0.72439826618, 0.3807932645, 3.89004920679, 0.036941610201, -1.0, -0.202810271, -0.356},
      {0.79013593844, 0.75, 3.85554413574, 0.071446681246, 0.595826261, 0.352713557, -0.81},
  };
  for (const Row& row : rows) {
    CAPTURE(row.voltage);
    const PeriodicOrbit orbit = impacting_orbit(row.voltage, row.impact_velocity, row.phase_guess);
    REQUIRE(orbit.converged);
    CHECK(orbit.map.segments[0].end(2) == Approx(row.impact_velocity).epsilon(2e-9));
    CHECK(orbit.map.segments[0].duration == Approx(row.t1).epsilon(1e-10));
    CHECK(orbit.map.segments[1].duration == Approx(row.t2).epsilon(1e-9));
    CHECK(multiplier(orbit, 0) == Approx(row.mu1).epsilon(1e-7));
    CHECK(multiplier(orbit, 1) == Approx(row.mu2).epsilon(1e-7));
  }
}

// Relay feedback of third order, as problems/relay/Makefile runs it, against matrix exponentials. The model and the two
// sets of parameters are those of M. di Bernardo, K. H. Johansson and F. Vasca, Int. J. Bifurcation and Chaos 11 (2001)
// 1121-1140: a limit cycle with sliding at zeta = omega = lambda = rho = 1, sigma = -1, one with several sliding
// segments at zeta = 0.05, omega = 8.
//
// All fields are affine, and half of a symmetric orbit determines it: from (0, 1, w), where it has left the surface
// with u = -1, back to x1 = 0, and along it to (0, -1, -w).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/exponential_flow.hpp"
#include "published/makefile_run.hpp"
#include "published/newton.hpp"

using namespace test_support;

namespace {

using Vector = Eigen::VectorXd;

struct Relay {
  double zeta, omega, lambda = 1.0, sigma = -1.0, rho = 1.0;

  AffineFlow flow(double u) const {
    Eigen::Matrix3d A;
    A << -(2 * zeta * omega + lambda), 1, 0, -(2 * zeta * omega * lambda + omega * omega), 0, 1,
        -lambda * omega * omega, 0, 0;
    return {A, u * Eigen::Vector3d(1.0, 2 * sigma * rho, rho * rho)};
  }
  /// On x1 = 0 the relay gives u = -x2 on average.
  AffineFlow sliding() const {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    A(1, 1) = -2 * sigma * rho;
    A(1, 2) = 1;
    A(2, 1) = -rho * rho;
    return {A, Eigen::Vector3d::Zero()};
  }
};

/// The limit cycle with one sliding segment in each half. `z`: w and the two durations.
Vector cycle(const Relay& relay, const Vector& z) {
  return newton(z, 1e-11, [&](const Vector& at) {
    const Vector met = relay.flow(-1.0).after(at(1), Eigen::Vector3d(0, 1, at(0)));
    const Vector left = relay.sliding().after(at(2), Eigen::Vector3d(0, met(1), met(2)));
    Vector values = Vector::Zero(3);
    values << met(0), left(1) + 1.0, left(2) + at(0);
    return values;
  });
}

/// Sliding begins: no sliding segment left, so that the flow alone leads from (0, 1, w) to minus that. `z`: w, the half
/// period, omega.
Vector crossing(double zeta, const Vector& z) {
  return newton(z, 1e-11, [&](const Vector& at) {
    const Vector met = Relay{zeta, at(2)}.flow(-1.0).after(at(1), Eigen::Vector3d(0, 1, at(0)));
    Vector values = Vector::Zero(3);
    values << met(0), met(1) + 1.0, met(2) + at(0);
    return values;
  });
}

/// Sliding touches x2 = 1, where x2' = x3 + 2 x2 = 0, on its way to x2 = -1. `z`: w, the durations of the flight and of
/// sliding before and after the contact, omega.
Vector adding(double zeta, const Vector& z) {
  return newton(z, 1e-11, [&](const Vector& at) {
    const Relay relay{zeta, at(4)};
    const Vector met = relay.flow(-1.0).after(at(1), Eigen::Vector3d(0, 1, at(0)));
    const Vector touching = relay.sliding().after(at(2), Eigen::Vector3d(0, met(1), met(2)));
    const Vector left = relay.sliding().after(at(3), touching);
    Vector values = Vector::Zero(5);
    values << met(0), touching(1) - 1.0, touching(2) + 2.0, left(1) + 1.0, left(2) + at(0);
    return values;
  });
}

}  // namespace

TEST_CASE("make -j2 in problems/relay: cycles with sliding, their beginning and their second sliding segment") {
  const MakefileRun chain("relay", "branches");
  chain.check_repeatable();
  chain.check_verified();

  for (const SolutionEntry& orbit : chain.solutions("cycle")) {
    INFO("zeta = " << orbit.parameter(1));
    Vector z = Vector::Zero(3);
    z << orbit.states.front()[2], orbit.parameter(61), orbit.parameter(62);
    const Vector half = cycle({orbit.parameter(1), 1.0}, z);
    for (int s = 0; s < 4; ++s) check_near(orbit.parameter(61 + s), half(1 + s % 2));
  }

  const SolutionEntry touching = chain.solution("sliding", "GR", 1);
  Vector z = Vector::Zero(5);
  const double tau = touching.internal[3];
  z << touching.states.front()[2], touching.parameter(61), tau * touching.parameter(62),
      (1.0 - tau) * touching.parameter(62), touching.parameter(2);
  const Vector added = adding(0.05, z);
  check_near(touching.parameter(2), added(4));
  check_near(touching.parameter(61), added(1));

  const SolutionEntry begins = chain.solution("sliding", "GR", 2);
  Vector y = Vector::Zero(3);
  y << begins.states.front()[2], begins.parameter(61), begins.parameter(2);
  const Vector begun = crossing(0.05, y);
  check_near(begins.parameter(2), begun(2));
  check_near(begins.parameter(61), begun(1));

  const std::string told = chain.tchat({"labels", "q.sliding"}).text();
  CHECK(told.find("adding-sliding: ") != std::string::npos);
  CHECK(told.find("crossing-sliding: ") != std::string::npos);

  // Both curves: from point to point.
  for (const PointSection& section : chain.points("crossing_curve")) {
    Vector at = begun;
    for (const PointRow& row : section.rows) {
      at = crossing(row.values[section.column("zeta")], at);
      check_near(row.values[section.column("omega")], at(2));
    }
  }
  for (const PointSection& section : chain.points("adding_curve")) {
    Vector at = added;
    for (const PointRow& row : section.rows) {
      at = adding(row.values[section.column("zeta")], at);
      check_near(row.values[section.column("omega")], at(4));
    }
  }

  // Two sliding segments in each half, on to where the second one parts from the first.
  CHECK(chain.solutions("multisliding").front().states.front().size() == 24);
}

TEST_CASE("a relay with hysteresis and a plant of first order: the textbooks' period 2 ln((1 + e) / (1 - e))") {
  const Workspace workspace;
  workspace.write("relay.tch",
                  "par e = 0.5\n"
                  "field up: x' = 1 - x\n"
                  "field down: x' = -1 - x\n"
                  "event high = e - x\n"
                  "event low = x + e\n");
  workspace.write("gc.relay",
                  "NDIM = 1, IPS = 180, ICP = [e, period]\nNTST = 10, NMX = 100, NPR = 5, RL0 = 0.05, RL1 = 0.95\n"
                  "GCFIND = [1, 2], GCHIND = [1, 2], GCGIND = [0, 0]\n"
                  "EPSL = 1e-11, EPSU = 1e-11, DS = 0.02, DSMAX = 0.1, UZR = {period: 4}\n");
  workspace.write("relay.dat", "# PAR(61) = 1\n# PAR(62) = 1\n0 -0.5 0.5\n0.5 0 0\n1 0.5 -0.5\n");
  const Outcome outcome = workspace.tchat(std::vector<std::string>{"run", "relay", "-q", "--both"});
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const std::vector<SolutionEntry> labels = workspace.solutions("relay");
  REQUIRE(labels.size() > 8);
  for (const SolutionEntry& u : labels) {
    const double e = u.parameter(1);
    check_near(u.parameter(61) + u.parameter(62), 2 * std::log((1 + e) / (1 - e)), 1e-9);
  }
  // A period of 4: e = tanh 1.
  const auto is_four = [](const SolutionEntry& u) { return u.type == -4; };
  const auto four = std::find_if(labels.begin(), labels.end(), is_four);
  REQUIRE(four != labels.end());
  check_near(four->parameter(1), std::tanh(1.0), 1e-9);
}

// First contacts of the tori of chapters 3 and 4 with the wall, by problems/fvdp and problems/rand4d as `make tori`
// runs them: beside the dissertation's figures, on other meshes and sections, and along curves of such tori beside the
// least values of simulated motions.
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"
#include "published/smooth_motion.hpp"

using namespace test_support;

namespace {

constexpr int returns = 20000;
/// A polynomial through points of the simulated torus against the collocation with NTST = 20, which leaves 1e-9.
constexpr double agreement = 5e-9;

/// mu where the torus of a run touches.
double contact(const MakefileRun& chain, const std::string& run) { return chain.only(run, "GR").parameter(1); }

/// A number of the sentence about a label's contact, "x3 = 2.9".
double told(const DiagnosticPoint& point, const std::string& name) {
  for (const std::string& note : point.notes) {
    const auto at = note.find(", " + name + " = ");
    if (at != std::string::npos) return std::stod(note.substr(at + name.size() + 5));
  }
  FAIL("nothing is told of " << name);
  return 0.0;
}

/// Of the forced van der Pol oscillator, c = 0.1, omega = 1.505, in (-x1, x2): the least -x1.
double least_of_fvdp(double amplitude) {
  constexpr double c = 0.1, omega = 1.505;
  const auto field = [=](const MotionState<2>& x, MotionState<2>& f, double t) {
    f[0] = -x[1];
    f[1] = x[0] - c * x[1] * (x[0] * x[0] - 1.0) + amplitude * std::cos(omega * t);
  };
  const auto velocity = [](const MotionState<2>& x, double) { return x[1]; };
  return least_at_falls(SmoothMotion<2, decltype(field), decltype(velocity)>(field, velocity, {-1.0, 0.0}, 0.1), 0,
                        omega, 2000, returns);
}

/// Of the forced oscillator (5.76)-(5.78), omega = 1.9: the least x1.
double least_of_rand4d(double amplitude) {
  constexpr double m = 0.28, omega = 1.9;
  const auto field = [=](const MotionState<3>& x, MotionState<3>& f, double t) {
    f[0] = (m - x[2]) * x[0] - x[1];
    f[1] = m * x[1] + x[0] + amplitude * std::cos(omega * t);
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
  };
  const auto falling = [=](const MotionState<3>& x, double) { return -((m - x[2]) * x[0] - x[1]); };
  return least_at_falls(SmoothMotion<3, decltype(field), decltype(falling)>(field, falling, {-0.3, 0.5, 0.2}, 0.06), 0,
                        omega, 2000, returns);
}

}  // namespace

TEST_CASE("fvdp: first contact of the torus, on two sections and meshes, and tori in contact along A") {
  const MakefileRun chain("fvdp", "tori_runs");
  const double mu = contact(chain, "tori_wall");
  CHECK(std::abs(mu - 2.4053817) < 5e-8);  // the dissertation's
  const double phase = told(chain.point("tori_wall", "GR"), "x3");
  CHECK(std::abs(phase - 2.923685) < 5e-7);

  // Digits beyond: points of P' in place of the ends of revolutions, another mesh, other harmonics.
  CHECK(std::abs(contact(chain, "tori_phase_wall") - mu) < 1e-9);
  chain.run("-c " + chain.constants("tori") + " -s tori -o finer NTST=60 NHARM=40 HARMTOL=0");
  CHECK(std::abs(contact(chain, "finer") - mu) < 1e-9);
  CHECK(std::abs(told(chain.point("finer", "GR"), "x3") - phase) < 1e-8);

  CHECK(std::abs(-least_of_fvdp(0.75) - mu) < agreement);
  int points = 0;
  for (const SolutionEntry& torus : chain.solutions("tori_grazing")) {
    const double amplitude = torus.parameter(3);
    if (amplitude < 0.39 || amplitude > 1.21) continue;
    CAPTURE(amplitude);
    CHECK(std::abs(-least_of_fvdp(amplitude) - torus.parameter(1)) < agreement);
    ++points;
  }
  CHECK(points >= 5);
}

TEST_CASE("rand4d: first contacts of the tori at A = 1.1 and at A = 1.5, omega = 4, where P is no section") {
  const MakefileRun chain("rand4d", "tori_walls");
  const double slow = contact(chain, "tori_wall");
  CHECK(std::abs(slow - -0.729707534) < 1e-9);  // the dissertation's
  chain.run("-c " + chain.constants("tori_wall") + " -s tori -o finer NTST=40 NHARM=55 HARMTOL=0");
  CHECK(std::abs(contact(chain, "finer") - slow) < 1e-9);

  const double fast = contact(chain, "tori_fast_wall");
  CHECK(std::abs(fast - -0.85480) < 5e-6);                          // the dissertation's
  CHECK(std::abs(contact(chain, "tori_late_wall") - fast) < 1e-9);  // half a revolution later
  chain.run("-c " + chain.constants("tori_fast") + " -s tori_fast -o fine NTST=50 NHARM=40 HARMTOL=0");
  CHECK(std::abs(contact(chain, "fine") - fast) < 1e-9);
}

TEST_CASE("rand4d: tori in contact from their birth at TR down to A = 1, beside simulated motions at five A") {
  const MakefileRun chain("rand4d", "tori_curve");
  const double birth = chain.only("torus", "TR").parameter(2);
  CHECK(std::abs(birth - 1.2528620) < 1e-7);
  int points = 0;
  for (const SolutionEntry& torus : chain.solutions("tori_grazing")) {
    const double amplitude = torus.parameter(2);
    const double fifth = 20.0 * amplitude;
    if (std::abs(fifth - std::round(fifth)) > 1e-6) continue;
    CAPTURE(amplitude);
    CHECK(std::abs(least_of_rand4d(amplitude) - torus.parameter(1)) < agreement);
    ++points;
  }
  CHECK(points == 4);
  CHECK(std::abs(least_of_rand4d(1.1) - contact(chain, "tori_wall")) < agreement);
  // Small steps past rho = 16/35, where harmonics 35, 70, ... grow.
  chain.run("-c r.tori_grazing -s tori_grazing -o past IRS=UZ3 UZR={} DS=-0.0001 DSMAX=0.0002 NMX=9");
  const PointSection past = chain.points("past").front();
  CHECK(past.rows.front().values[past.column("rho")] > 16.0 / 35.0);
  CHECK(past.rows.back().values[past.column("rho")] < 16.0 / 35.0);
  const PointSection up = chain.points("tori_grazing").front();
  CHECK(std::abs(up.rows.back().values[up.column("A")] - birth) < 1e-6);  // there it has shrunk to the periodic orbit
}

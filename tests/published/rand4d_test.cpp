// The forced oscillator (5.76)-(5.78) by the real executable, as problems/rand4d/Makefile runs it: published state,
// multipliers and fold of the orbit with one impact every two forcing periods, and where its branch ends, by shooting.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "motion/orbit_flow.hpp"
#include "published/makefile_run.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

constexpr double omega = 1.9;

/// x1' at the end of the orbit.
double impact_velocity(const SolutionEntry& solution) {
  const auto& x = solution.states.back();
  return (solution.parameter(4) - x[2]) * x[0] - x[1];
}

/// (4.7) without the wall: (x1, x2, x3) and an angle x4, whose jump 2 takes off 2 pi. PAR: A.
struct ForcedOscillator {
  static constexpr int dimension = 4, parameters = 1, fields = 1, events = 1, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = 0.28 * x[0] - x[1] - x[0] * x[2];
    f[1] = 0.28 * x[1] + x[0] + p[0] * cos(x[3]);
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
    f[3] = T(omega);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1] + x[0] * x[2] - 0.28 * x[0];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 2) g[3] = x[3] - 2.0 * M_PI;
  }
};

/// The smooth orbit of one forcing period, from its minimum of x1.
tchat::PeriodicOrbit smooth_orbit(const std::vector<double>& x, double amplitude) {
  const Eigen::Vector4d guess(x[0], x[1], x[2], std::atan2(x[3], x[4]));
  const auto orbit = tchat::shoot(tchat::test::system_of<ForcedOscillator>(), {{1, 1, 2}}, guess,
                                  Eigen::VectorXd::Constant(1, amplitude));
  INFO(orbit.message);
  REQUIRE(orbit.converged);
  return orbit;
}

/// One impact every two forcing periods, state, multipliers and fold (Fig. 5.18).
void check_impacting(const MakefileRun& chain) {
  const auto points = chain.diagnostics("impacting");
  const auto solutions = chain.solutions("impacting");

  const SolutionEntry& first = with_label(solutions, 1);
  CHECK(first.parameter(1) == -0.4938);
  CHECK(std::abs(first.parameter(61) - 4.0 * M_PI / omega) < 1e-9);
  const auto& x = first.states.back();
  const double expected[] = {-0.4938, 1.35553833, 1.30754970, std::sin(2.08040371), std::cos(2.08040371)};
  for (std::size_t k = 0; k < 5; ++k) check_near(x[k], expected[k], 5e-9);  // eight decimals are published
  CHECK(points.front().point < 0);
  for (const double mu : {-0.28719637, -0.08216043, 0.00267411})
    CHECK(distance_to(points.front().multipliers, mu) < 5e-9);
  CHECK(first_iterations(chain.read("d.impacting")) <= 4);  // of the start that simulation found
  CHECK(first_iterations(chain.read("d.torus")) <= 4);

  const SolutionEntry fold = chain.only("impacting", "LP");
  check_near(fold.parameter(1), -0.62259796203);
  check_near(impact_velocity(fold), -0.2154701, 5e-8);
  CHECK(std::abs(fold.parameter(61) - 4.0 * M_PI / omega) < 1e-9);
  for (const double mu : {1.0, 0.67853149, 0.00225252})
    CHECK(distance_to(with_label(points, fold.label).multipliers, mu) < 5e-9);
  // Stable between the period doubling and the fold.
  const double doubling = chain.only("impacting", "PD").parameter(1);
  for (const PointSection& section : chain.points("impacting"))
    for (const PointRow& row : section.rows) {
      const double v = row.values[section.column("velocity")];
      if (std::abs(v + 0.2154701) > 1e-4 && row.type != 7)
        CHECK((row.point < 0) == (v < -0.2154701 && row.values[0] < doubling));
    }
}

/// Of x1 at A = 1.25 without the wall, by simulation.
double lowest_minimum_on_torus(const MakefileRun& chain) {
  const Outcome outcome =
      chain.tchat({"simulate", "rand4d", "-q", "-p", chain.plugin(), "PAR(mu)=-2", "--transient-events", "1000",
                   "--events", "1000", "--rows", "0", "-o", "quasiperiodic"});
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  std::istringstream events(chain.read("quasiperiodic.events"));
  double lowest = 0.0;
  for (std::string line; std::getline(events, line);) {
    if (line.starts_with("#")) continue;
    const auto words = words_of(line);
    lowest = std::min(lowest, std::stod(words.at(7)));
  }
  return lowest;
}

/// The branch ends where the smooth orbit of one forcing period grazes, run through twice.
void check_end_of_branch(const MakefileRun& chain) {
  const SolutionEntry contact = chain.only("grazing", "GR");
  const auto smooth = smooth_orbit(contact.states.front(), 1.25);
  CHECK(std::abs(smooth.map.period - 2.0 * M_PI / omega) < 1e-12);
  CHECK(std::abs(contact.parameter(1) - smooth.start(0)) < 1e-9);

  // Its impact velocity vanishes there, and its other minimum, one forcing period later, touches the wall too.
  const SolutionEntry end = chain.only("impacting", "GR");
  CHECK(std::abs(end.parameter(1) - smooth.start(0)) < 1e-7);
  CHECK(std::abs(impact_velocity(end)) < 1e-6);
  const auto points = chain.diagnostics("impacting");
  const std::string note = with_label(points, end.label).notes.back();
  CHECK(note.find("tau = 0.5") != std::string::npos);
  CHECK(note.find("h_x f = 0 at the end of segment 1") != std::string::npos);
  // Not at mu = -0.4940, where the torus grazes.
  for (const PointRow& row : rows_of(chain.points("impacting")))
    CHECK((row.type != -4 || std::abs(row.values[0] + 0.4940) > 0.01));
  const double lowest = lowest_minimum_on_torus(chain);
  CHECK(lowest < -0.4940);
  CHECK(lowest > -0.4942);

  // The torus is born from that orbit at A = 1.252862, where a pair of its multipliers is on the unit circle.
  const SolutionEntry birth = chain.only("torus", "TR");
  const auto modulus = [&](double amplitude) {
    return std::abs(smooth_orbit(birth.states.front(), amplitude).map.multipliers(0)) - 1.0;
  };
  const double a = birth.parameter(2);
  const double slope = (modulus(a + 1e-4) - modulus(a - 1e-4)) / 2e-4;
  CHECK(slope != 0.0);
  CHECK(std::abs(modulus(a) / slope) < 1e-7);
  CHECK(a == Approx(1.2529).margin(1e-4));
}

/// The doubled orbit and the fold curve.
void check_doubled_and_folds(const MakefileRun& chain) {
  const SolutionEntry doubling = chain.only("impacting", "PD");
  CHECK(distance_to(with_label(chain.diagnostics("impacting"), doubling.label).multipliers, -1.0) < 1e-6);
  const auto doubled = chain.points("doubled").front();
  CHECK(doubled.rows.front().values[0] == Approx(doubling.parameter(1)).margin(1e-4));
  for (const PointRow& row : doubled.rows)
    CHECK(row.values[doubled.column("PERIOD")] == Approx(8.0 * M_PI / omega).epsilon(1e-9));
  double least = 10.0, largest = 0.0;
  for (const PointSection& section : chain.points("fold_curve"))
    for (const PointRow& row : section.rows) {
      least = std::min(least, row.values[section.column("A")]);
      largest = std::max(largest, row.values[section.column("A")]);
    }
  CHECK(least < 1.0);
  CHECK(largest > 1.6);
  for (const DiagnosticPoint& point : chain.diagnostics("fold_curve"))
    CHECK(distance_to(point.multipliers, 1.0) < 1e-6);
}

}  // namespace

TEST_CASE("make -j2 in problems/rand4d: every published value") {
  const MakefileRun chain("rand4d");
  chain.check_verified();
  chain.check_repeatable(MakefileRun::Chain::is_long);
  check_impacting(chain);
  check_end_of_branch(chain);
  check_doubled_and_folds(chain);
}

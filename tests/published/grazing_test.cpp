// Grazing of the nonimpacting orbit and the grazing curve of the linear oscillator, against closed forms.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <set>

#include "end_to_end/closed_forms.hpp"
#include "published/chain.hpp"

using namespace test_support;
using Catch::Matchers::Contains;

namespace {

/// Where the amplitude alpha / |(1 - omega^2) + 2 i zeta omega| is 1, omega > 1, for alpha = 3: the larger root of
/// W^2 - 2 (1 - 2 zeta^2) W + 1 - alpha^2 = 0 in W = omega^2.
double grazing_omega() {
  const double half = 1.0 - 2.0 * zeta * zeta;
  return std::sqrt(half + std::sqrt(half * half + 8.0));
}

/// x1 falls short of the wall by this much at the start of the orbit cut at its minimum, where tau = 1/2 is its
/// maximum.
std::string data_from_minimum() {
  const NonimpactingOrbit orbit(3.0, 2.0, zeta);
  std::string text = "# PAR(1) = 3\n# PAR(2) = 2\n# PAR(3) = 0.05\n# PAR(4) = 0.8\n";
  for (int k = 0; k <= 64; ++k) {
    const double time = orbit.period() * k / 64.0;
    const State x = orbit.at(time + 0.5 * orbit.period());
    char row[200];
    std::snprintf(row, sizeof row, "%.16f %.16f %.16f %.16f %.16f\n", time, x[0], x[1], x[2], x[3]);
    text += row;
  }
  return text;
}

void check_grazing(const Workspace& workspace, double tau) {
  const SolutionEntry grazing = only(workspace, "grazing", "GR");
  CHECK(std::abs(grazing.parameter(2) - 1.998333565522409) < 1e-8);
  CHECK(std::abs(grazing.parameter(2) - grazing_omega()) < 1e-8);
  REQUIRE(grazing.internal.size() == 4);
  CHECK(grazing.internal[0] == 2.0);  // contact inside a segment, of segment 1 with event 1
  CHECK(grazing.internal[1] == 1.0);
  CHECK(grazing.internal[2] == 1.0);
  CHECK(std::abs(grazing.internal[3] - tau) < 1e-6);
  // It is the last point: the branch ends there.
  const auto sections = workspace.points("grazing");
  CHECK(sections.front().rows.back().label == grazing.label);
  CHECK(sections.front().rows.back().type == -4);
  const auto points = read_diagnostics(workspace.read("d.grazing"));
  REQUIRE(points.back().notes.size() == 1);
  CHECK_THAT(points.back().notes.front(),
             Contains("segment 1") && Contains("event 1 (wall)") && Contains("tau = ") && Contains("x1 = 1,"));
}

/// xi_n = (1 + r) omega^2 exp(-zeta n T) sin(n omega_d T) / omega_d
double xi(int n, double omega) {
  const double omega_d = std::sqrt(1.0 - zeta * zeta);
  const double time = n * 2.0 * M_PI / omega;
  return (1.0 + restitution) * omega * omega * std::exp(-zeta * time) * std::sin(omega_d * time) / omega_d;
}

}  // namespace

TEST_CASE("grazing in omega, the contact at the orbit's own section") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  check_grazing(workspace, 0.0);
}

TEST_CASE("grazing in omega, the contact inside the segment") {
  const Workspace workspace;
  workspace.write("minimum.dat", data_from_minimum());
  for (const char* mesh : {"NTST=50 NCOL=4", "NTST=75 NCOL=4", "NTST=200 NCOL=4", "NTST=50 NCOL=6"}) {
    INFO(mesh);
    workspace.run(std::string("-c to_grazing -d minimum -o grazing GCHIND=[3] ") + mesh);
    check_grazing(workspace, 0.5);
  }
}

TEST_CASE("grazing curve: alpha(omega), xi_n and all its zeros") {
  const Workspace workspace;
  run_to_grazing_curve(workspace);
  const auto sections = workspace.points("grazing_curve");
  REQUIRE(sections.size() == 2);
  // RL0 and RL1 of gc.grazing_curve: special points beyond them are no labels.
  constexpr double lower_bound = 0.5, upper_bound = 4.0;
  double least = 10.0, largest = 0.0;
  for (const PointSection& section : sections)
    for (const PointRow& row : section.rows) {
      const double omega = row.values[section.column("omega")];
      INFO("omega = " << omega);
      CHECK(std::abs(row.values[section.column("alpha")] - std::hypot(1.0 - omega * omega, 2.0 * zeta * omega)) < 1e-9);
      least = std::min(least, omega);
      largest = std::max(largest, omega);
    }
  // Both ways it ended at the bound, just beyond it.
  CHECK(least <= lower_bound);
  CHECK(least > lower_bound - 0.2);
  CHECK(largest >= upper_bound);
  CHECK(largest < upper_bound + 0.2);

  // Every zero of every xi_n within the bounds, and no other, has a label that names n.
  const auto points = read_diagnostics(workspace.read("d.grazing_curve"));
  const auto solutions = workspace.solutions("grazing_curve");
  std::multiset<double> labelled[6];
  for (const DiagnosticPoint& point : of_type(points, "XI"))
    for (int n = 1; n <= 5; ++n)
      for (const std::string& note : point.notes)
        if (note.find("xi_" + std::to_string(n) + " = 0") != std::string::npos)
          labelled[n].insert(with_label(solutions, point.label).parameter(2));
  const double omega_d = std::sqrt(1.0 - zeta * zeta);
  for (int n = 1; n <= 5; ++n) {
    INFO("n = " << n);
    std::multiset<double> expected;
    for (int k = 1; k <= 100; ++k)
      if (const double omega = 2.0 * n * omega_d / k; omega >= lower_bound && omega <= upper_bound)
        expected.insert(omega);
    REQUIRE(expected.size() >= static_cast<std::size_t>(n) * 3);
    REQUIRE(labelled[n].size() == expected.size());
    for (auto a = labelled[n].begin(), b = expected.begin(); b != expected.end(); ++a, ++b)
      CHECK(std::abs(*a - *b) < 1e-7);
  }

  // xi_n itself, a* = omega^2, and the smooth multipliers at every labelled point.
  int compared = 0;
  for (const DiagnosticPoint& point : points) {
    if (point.label == 0 || point.branch == 0) continue;
    const auto entry = std::find_if(solutions.begin(), solutions.end(),
                                    [&](const SolutionEntry& s) { return s.label == point.label; });
    if (entry == solutions.end()) continue;
    const double omega = entry->parameter(2);
    INFO("omega = " << omega);
    for (int n = 1; n <= 5; ++n) {
      const auto value = point.tests.find("xi_" + std::to_string(n));
      REQUIRE(value != point.tests.end());
      CHECK(std::abs(value->second - xi(n, omega)) < 1e-7 * omega * omega);
    }
    const double time = 2.0 * M_PI / omega;
    CHECK(distance_to(point.multipliers, std::polar(std::exp(-zeta * time), omega_d * time)) < 1e-7);
    ++compared;
  }
  CHECK(compared > 30);
}

// The wall is touched where alpha = |1 - omega^2 + 2 i zeta omega|: least at omega^2 = 1 - 2 zeta^2.
TEST_CASE("the grazing curve turns in alpha at the closed-form resonance, and ILP = -1 ends it there") {
  const Workspace workspace;
  run_to_grazing_curve(workspace);
  const double omega = std::sqrt(1.0 - 2.0 * zeta * zeta), alpha = 2.0 * zeta * std::sqrt(1.0 - zeta * zeta);
  for (const char* step : {"-0.02 DSMAX=0.05", "-0.1 DSMAX=0.4"}) {
    workspace.run(std::string("-c grazing_curve -s grazing -o turn ICP=[alpha,omega] RL0=0.05 RL1=4 UZR={} DS=") +
                  step);
    const SolutionEntry found = only(workspace, "turn", "LP");
    CHECK(found.type == 5);
    CHECK(std::abs(found.parameter(1) - alpha) < 1e-9);
    CHECK(std::abs(found.parameter(2) - omega) < 1e-7);  // alpha is flat there
  }
  workspace.run("-c grazing_curve -s grazing -o ended ICP=[alpha,omega] RL0=0.05 RL1=4 UZR={} DS=-0.02 ILP=-1");
  CHECK(workspace.solutions("ended").back().type == 5);
  workspace.run("-c grazing_curve -s grazing -o none ICP=[alpha,omega] RL0=0.05 RL1=4 UZR={} DS=-0.02 ILP=0");
  for (const SolutionEntry& solution : workspace.solutions("none")) CHECK(solution.type != 5);
  // No curve in three parameters begins there.
  const Outcome refused = workspace.tchat("run linosc -c grazing_curve -s turn -o refused IRS=LP1 ISW=2");
  CHECK(refused.status != 0);
  CHECK(refused.text().find("IPS = 150 with ISW = 2 is not a problem") != std::string::npos);
}

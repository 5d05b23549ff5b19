// Monitors that are watched and held, against the closed form of the linear impact oscillator (end_to_end/closed_forms)
// and of its multipliers (impact_matrix.hpp).
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/closed_forms.hpp"
#include "published/chain.hpp"
#include "published/impact_matrix.hpp"
#include "published/makefile_run.hpp"
#include "support/linear_oscillator.hpp"
#include "support/random_matrices.hpp"

using namespace test_support;

namespace {

double velocity(const SolutionEntry& solution) { return solution.states.back().at(1); }

double closed_alpha(const SolutionEntry& solution) {
  return ImpactingOrbit(velocity(solution), solution.parameter(2), zeta, restitution).alpha();
}

/// The impacting orbits in alpha at omega = 2.0072, watched, from the label of the plain run.
void run_watched(const Workspace& workspace) {
  run_impacting(workspace, "20072");
  const std::vector<SolutionEntry> plain = workspace.solutions("impacting_20072");
  workspace.run({"-c", "impacting_20072", "-s", "impacting_20072", "-o", "watched",
                 "IRS=" + std::to_string(plain[1].label), "DS=0.02", "NMX=40", "NPR=1",
                 "ICP=[alpha, velocity(1), end(x2, 1), max(x1), mean(x1), multiplier(1), 61]",
                 "UZR={velocity(1): [-2, -3], \"max( x2 )\": 3.5}"});
}

std::vector<std::string> held_words(double velocity) {
  return {"-c",      "impacting_20072",
          "-s",      "watched",
          "-o",      "held",
          "IRS=UZ3", "ICP=[omega, alpha]",
          "UZR={}",  "RL0=1.6",
          "RL1=2.8", "NMX=80",
          "NPR=4",   "HOLD={velocity(1): " + fmt::format("{}", velocity) + "}"};
}

}  // namespace

TEST_CASE("watched monitors are columns, and their values are located") {
  const Workspace workspace;
  run_watched(workspace);
  const std::vector<PointSection> sections = workspace.points("watched");
  // columns: alpha, norm, maximum, then the further entries of ICP, the period
  const std::vector<SolutionEntry> labels = workspace.solutions("watched");
  REQUIRE(labels.size() > 5);
  for (const SolutionEntry& label : labels) {
    const PointRow& row = with_label(sections, label.label);
    const std::size_t first = row.values.size() - 7;
    const double v = velocity(label);
    INFO("label " << label.label);
    CHECK(row.values[first] == Approx(-v).epsilon(1e-10));  // h = 1 - x1, so h_x f = -x2
    CHECK(row.values[first + 1] == Approx(v).epsilon(1e-10));
    CHECK(row.values[first + 2] == Approx(1.0).epsilon(1e-10));
    const ScaledMonodromy closed(label);
    const double modulus = tchat::test::lapack_eigenvalues(closed.matrix / closed.velocities).cwiseAbs().maxCoeff();
    CHECK(row.values[first + 4] == Approx(modulus).epsilon(1e-8));
  }
  const auto is_at = [&](double wanted) {
    return std::count_if(labels.begin(), labels.end(),
                         [&](const SolutionEntry& label) { return std::abs(-velocity(label) - wanted) < 1e-8; });
  };
  CHECK(is_at(-2.0) == 1);
  CHECK(is_at(-3.0) == 1);
}

TEST_CASE("impact velocity held: alpha over omega in closed form, multipliers and the period doubling too") {
  const Workspace workspace;
  run_watched(workspace);
  workspace.run(held_words(-3.0));
  const std::vector<SolutionEntry> labels = workspace.solutions("held");
  const std::vector<DiagnosticPoint> diagnostics = read_diagnostics(workspace.read("d.held"));
  REQUIRE(labels.size() > 8);
  for (const SolutionEntry& label : labels) {
    INFO("omega = " << label.parameter(2));
    check_near(velocity(label), 3.0, 1e-10);
    check_near(label.parameter(1), closed_alpha(label), 1e-9);
    const DiagnosticPoint& point = with_label(diagnostics, label.label);
    const ScaledMonodromy closed(label);
    const Eigen::VectorXcd expected = tchat::test::lapack_eigenvalues(closed.matrix / closed.velocities);
    for (const std::complex<double>& mu : expected) CHECK(distance_to(point.multipliers, mu) < 1e-8);
  }
  const SolutionEntry doubling = only(workspace, "held", "PD");
  check_near(ScaledMonodromy(doubling).at_minus_one(), 0.0, 1e-6);
}

TEST_CASE("a monitor's value as principal parameter, a zero of a monitor located, restarted from and followed") {
  const Workspace workspace;
  run_watched(workspace);
  // Along the impact velocity itself, to a phase of the impact that is located.
  workspace.run({"-c", "impacting_20072", "-s", "watched", "-o", "along", "IRS=UZ3", "ICP=[velocity(1), alpha]",
                 "UZR={end(y2): -0.97}", "RL0=-6", "RL1=-0.5", "NMX=60", "DS=-0.05"});
  const SolutionEntry zero = only(workspace, "along", "UZ");
  check_near(zero.states.back().at(3), -0.97, 1e-9);
  check_near(zero.parameter(1), closed_alpha(zero), 1e-9);
  // From there, held, in two parameters.
  workspace.run({"-c", "impacting_20072", "-s", "along", "-o", "curve", "IRS=UZ1", "ICP=[omega, alpha]",
                 "HOLD=[end(y2)]", "RL0=1.9", "RL1=2.2", "NMX=40", "NPR=3"});
  const std::vector<SolutionEntry> labels = workspace.solutions("curve");
  REQUIRE(labels.size() > 3);
  for (const SolutionEntry& label : labels) {
    check_near(label.states.back().at(3), -0.97, 1e-9);
    check_near(label.parameter(1), closed_alpha(label), 1e-9);
  }
}

TEST_CASE("period doublings with a held duration: a curve in three parameters") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  workspace.run({"-c", "impacting_20072", "-s", "impacting_20072", "-o", "three", "IRS=PD1", "ISW=2",
                 "ICP=[alpha, r, zeta]", "HOLD=[velocity(1)]", "RL0=2.9", "RL1=3.2", "NMX=20", "NPR=5", "DS=0.002",
                 "ICPMOVE=1"});
  const std::vector<SolutionEntry> labels = workspace.solutions("three");
  REQUIRE(labels.size() > 2);
  for (const SolutionEntry& label : labels) check_near(velocity(label), velocity(labels.front()), 1e-9);
}

TEST_CASE("resegment leaves monitors out of its constants, and says so") {
  const Workspace workspace;
  workspace.run({"-c", "to_grazing", "-d", "nonimpacting", "-o", "watched", "ICP=[omega, 61, max(x1, 1)]"});
  const Outcome outcome = workspace.tchat("resegment q.watched GR1 --to impacting --jump 1 -c r.watched -o born -p " +
                                          workspace.file("linosc"));
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(outcome.err.find("are left out of the new constants") != std::string::npos);
  CHECK(workspace.read("gc.born").find("max(") == std::string::npos);
}

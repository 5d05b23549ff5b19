// The torus curve of an impacting orbit: from end to end in both directions, its multipliers by integration.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "motion/orbit_flow.hpp"
#include "published/chain.hpp"
#include "published/two_walls.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

void command(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
}

/// q.born: the orbit that is born where the smooth one grazes wall B, with its torus bifurcations.
void run_to_torus(const Workspace& workspace) {
  std::filesystem::copy_file(TWO_WALLS_LIBRARY, workspace.file("walls.so"));
  command(workspace, "simulate walls -q -o simulated --dat smooth --free a");
  command(workspace, "run walls -q -c smooth -d smooth -o smooth NPR=0");
  command(workspace, "resegment -q -p walls q.smooth GR1 --to impacting -o born NPR=0 NMX=300 DS=0.01");
  command(workspace, "run walls -q -c born -s born -o torus");
}

/// The multiplier in the upper half plane that is nearest to the unit circle, of the orbit by integration.
std::complex<double> integrated_pair(const SolutionEntry& solution) {
  Eigen::VectorXd par(6);
  for (int k = 0; k < 6; ++k) par(k) = solution.parameter(k + 1);
  const Eigen::VectorXd start = Eigen::VectorXd::Map(solution.states.front().data(), 6);
  const tchat::PeriodicOrbit orbit =
      tchat::shoot(tchat::test::system_of<TwoWalls>(), {{1, 2, 2}, {1, 3, 3}}, start, par);
  REQUIRE(orbit.converged);
  CHECK((orbit.start - start).norm() < 1e-7);
  std::complex<double> nearest = 0.0;
  for (const std::complex<double> mu : orbit.map.multipliers)
    if (mu.imag() > 0.0 && std::abs(std::abs(mu) - 1.0) < std::abs(std::abs(nearest) - 1.0)) nearest = mu;
  return nearest;
}

/// The stored solutions of one direction are on the curve, up to where it ends at a double multiplier, omega there.
double check_curve(const std::vector<SolutionEntry>& solutions) {
  constexpr double near = 2e-3;  // in omega: there shooting has a nearly singular matrix or multipliers nearly double
  const double end = solutions.back().parameter(2);
  for (std::size_t i = 0; i + 1 < solutions.size(); ++i) {
    if (std::abs(solutions[i].parameter(2) - end) < near) continue;
    CAPTURE(solutions[i].label, solutions[i].parameter(2));
    const std::complex<double> mu = integrated_pair(solutions[i]);
    CHECK(std::abs(std::abs(mu) - 1.0) < 1e-6);
    if (solutions[i].type % 10 == -7) CHECK(std::abs(mu - std::polar(1.0, 2.0 * M_PI / 3.0)) < 1e-5);
    if (solutions[i].type % 10 == -8) CHECK(std::abs(mu - std::polar(1.0, M_PI / 2.0)) < 1e-5);
  }
  return end;
}

}  // namespace

TEST_CASE("torus curve of an impacting orbit: both directions, to the resonances where it ends, for any step") {
  const Workspace workspace;
  run_to_torus(workspace);
  const std::string curve = "run walls -q -s torus -c r.torus ISW=2 IRS=TR2 ICP=[2,1] NPR=3 NMX=80 ";
  std::vector<double> up, down;
  for (const char* changes : {"-o both --both", "-o both --both DS=-0.01", "-o both --both DS=0.02 DSMAX=0.05",
                              "-o both --both DS=0.001 NTST=80", "-o both --both EPSL=1e-7 EPSU=1e-7"}) {
    INFO(changes);
    command(workspace, curve + changes);
    std::vector<SolutionEntry> sides[2];
    const std::vector<SolutionEntry> all = workspace.solutions("both");
    for (const SolutionEntry& solution : all) sides[solution.branch == all.front().branch ? 0 : 1].push_back(solution);
    REQUIRE(sides[1].size() > 5);
    const bool turned = std::string(changes).find("DS=-") != std::string::npos;
    CHECK(sides[turned ? 1 : 0].back().type % 10 == -6);
    CHECK(sides[turned ? 0 : 1].back().type % 10 == -5);
    const auto points = read_diagnostics(workspace.read("d.both"));
    CHECK(distance_to(of_type(points, "R2").at(0).multipliers, -1.0) < 1e-3);  // double: to the root of the accuracy
    CHECK(distance_to(of_type(points, "R1").at(0).multipliers, 1.0) < 1e-3);
    up.push_back(check_curve(sides[turned ? 1 : 0]));
    down.push_back(check_curve(sides[turned ? 0 : 1]));
    CHECK(std::abs(up.back() - up.front()) < 1e-8);
    CHECK(std::abs(down.back() - down.front()) < 1e-8);
  }
}

TEST_CASE("torus curve of an impacting orbit: a run from the resonance where it ends goes back along it") {
  const Workspace workspace;
  run_to_torus(workspace);
  command(workspace, "run walls -q -s torus -c r.torus -o curve ISW=2 IRS=TR2 ICP=[2,1] NPR=0 NMX=80 --both");
  for (const char* end : {"R1", "R2"}) {
    INFO(end);
    const SolutionEntry start = only(workspace, "curve", end);
    // On both sides in turn: one leads back along the torus curve, past the TR label it came from.
    bool back = false;
    for (const char* ds : {"0.01", "-0.01"}) {
      const Outcome outcome = workspace.tchat("run walls -q -s curve -c r.curve -o back NMX=80 UZR={-2:1.5} IRS=" +
                                              std::to_string(start.label) + " DS=" + ds);
      INFO(outcome.text());
      if (outcome.status == 0) back = back || std::abs(workspace.solutions("back").back().parameter(2) - 1.5) < 1e-8;
    }
    CHECK(back);
  }
}

TEST_CASE("torus curve of an impacting orbit: the resonances on it for any step") {
  const Workspace workspace;
  run_to_torus(workspace);
  std::vector<double> third, fourth;
  for (const char* changes : {"DS=0.01", "DS=0.003 DSMAX=0.03", "DS=0.03", "NTST=100", "NCOL=5", "THL={}"}) {
    INFO(changes);
    command(workspace,
            "run walls -q -s torus -c r.torus -o curve ISW=2 IRS=TR2 ICP=[2,1] NPR=0 NMX=100 " + std::string(changes));
    third.push_back(only(workspace, "curve", "R3").parameter(2));
    fourth.push_back(only(workspace, "curve", "R4").parameter(2));
    CHECK(std::abs(third.back() - third.front()) < 1e-7);
    CHECK(std::abs(fourth.back() - fourth.front()) < 1e-7);
  }
}

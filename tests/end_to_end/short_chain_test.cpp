// The whole way on coarse meshes, short enough for the sanitizers: simulation, its hand-over, branches to grazing,
// every kind of resegmentation, curves in two parameters, a switch, restarts. What is checked is that each step leads
// to the next one, and values in closed form at the accuracy of the mesh.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

constexpr double zeta = 0.05;
const std::string coarse = " NTST=15 NPR=0 -q";

double grazing_alpha(double omega) { return std::hypot(1.0 - omega * omega, 2.0 * zeta * omega); }

void succeed(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
}

/// Nonimpacting orbit from rest, and in omega to its grazing.
void run_to_grazing(const Workspace& workspace) {
  succeed(workspace, "simulate linosc --dat found -q");
  succeed(workspace, "run linosc -c found -d found -o first NMX=4" + coarse);
  succeed(workspace, "run linosc -c to_grazing -d found -o grazing" + coarse);
}

}  // namespace

TEST_CASE("short chain: simulation, grazing, its curve, impacting orbits, their bifurcations") {
  const Workspace workspace;
  run_to_grazing(workspace);
  const auto grazing = workspace.solutions("grazing");
  const SolutionEntry& contact = grazing.back();
  CHECK(contact.parameter(1) == Approx(grazing_alpha(contact.parameter(2))).epsilon(1e-7));

  succeed(workspace, "run linosc -c grazing_curve -s grazing -o grazing_curve --both RL0=1.85 RL1=2.05" + coarse);
  succeed(workspace, "run linosc -c impacting_20072 -s grazing_curve -o impacting NMX=60" + coarse);
  succeed(workspace, "run linosc -c period_doubling_curve -s impacting -o period_doubling_curve NMX=5" + coarse);
  succeed(workspace, "run linosc -c doubled -s impacting -o doubled NMX=5" + coarse);
  succeed(workspace, "run linosc -c impacting_20072 -s impacting -o back IRS=PD1 DS=-0.01 NMX=5" + coarse);
  CHECK(workspace.tchat("labels q.impacting").status == 0);
  CHECK(workspace.tchat("orbit q.impacting PD1").status == 0);
}

TEST_CASE("short chain: every kind of resegmentation runs on") {
  const Workspace workspace;
  run_to_grazing(workspace);
  const auto resegment = [&](const std::string& arguments) {
    succeed(workspace, "resegment q.grazing GR1 -p linosc " + arguments);
  };
  resegment("--to grazing-curve -o curve ICP=[2,1,61]");
  succeed(workspace, "run linosc -c curve -s curve -o curve_run NMX=6" + coarse);
  resegment("--to impacting -o impacting");
  succeed(workspace, "run linosc -c impacting -s impacting -o impacting_run NMX=6" + coarse);
  resegment("--to rotate --by 1 -o rotated");
  resegment("--to double -o doubled");
  resegment("--to signature --signature 1,1,2 -o signature");
  for (const std::string name : {"rotated", "doubled"})
    succeed(workspace, "run linosc -c " + name + " -s " + name + " -o " + name + "_run NMX=3 GRSTOP=0" + coarse);
}

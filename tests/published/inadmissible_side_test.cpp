// Through impact velocity zero into solutions that the wall forbids: only folds, branch points and period doublings
// that the closed form confirms, and all of those.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/closed_forms.hpp"
#include "published/chain.hpp"
#include "published/impact_matrix.hpp"

using namespace test_support;

namespace {

struct Count {
  int at_plus_one = 0, at_minus_one = 0, velocity = 0;
};

/// Every point is in q.NAME (NPR = 1). Sign changes between its neighbours, in the order of the branch.
Count sign_changes(const std::vector<SolutionEntry>& solutions, int branch) {
  Count count;
  const SolutionEntry* before = nullptr;
  const auto special = [](const SolutionEntry& s) { return s.type == 5 || s.type == 6 || s.type == 7 || s.type == -4; };
  for (const SolutionEntry& solution : solutions) {
    if (solution.branch != branch || special(solution)) continue;
    if (before != nullptr) {
      const ScaledMonodromy a(*before), b(solution);
      count.at_plus_one += a.at_plus_one() * b.at_plus_one() < 0.0 ? 1 : 0;
      count.at_minus_one += a.at_minus_one() * b.at_minus_one() < 0.0 ? 1 : 0;
      count.velocity += a.velocities * b.velocities < 0.0 ? 1 : 0;
    }
    before = &solution;
  }
  return count;
}

Count labels(const std::vector<DiagnosticPoint>& points, int branch) {
  Count count;
  for (const DiagnosticPoint& point : points) {
    if (point.branch != branch) continue;
    count.at_plus_one += point.type == "LP" || point.type == "BP" ? 1 : 0;
    count.at_minus_one += point.type == "PD" ? 1 : 0;
    count.velocity += point.type == "GR" ? 1 : 0;
    // det M = r^(2 m) exp(-2 zeta T) < 1: no pair reaches the unit circle.
    CHECK(point.type != "TR");
    if (point.type == "LP" || point.type == "BP") CHECK(distance_to(point.multipliers, 1.0) < 1e-5);
    if (point.type == "PD") CHECK(distance_to(point.multipliers, -1.0) < 1e-5);
  }
  return count;
}

void check_branches(const Workspace& workspace, const std::string& name) {
  const auto points = read_diagnostics(workspace.read("d." + name));
  const auto solutions = workspace.solutions(name);
  int branch = 0;
  int impacts_reversed = 0;
  for (const SolutionEntry& solution : solutions) {
    if (solution.branch == branch) continue;
    branch = solution.branch;
    INFO(name << ", branch " << branch);
    const Count expected = sign_changes(solutions, branch), found = labels(points, branch);
    CHECK(found.at_plus_one == expected.at_plus_one);
    CHECK(found.at_minus_one == expected.at_minus_one);
    CHECK(found.velocity >= expected.velocity);  // contacts inside a segment are GR too
    impacts_reversed += expected.velocity;
  }
  CHECK(impacts_reversed > 0);
}

}  // namespace

TEST_CASE("one impact a period: through impact velocity zero, both omegas") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o p72 --both GRSTOP=0 NPR=1 NMX=150 RL0=1 RL1=6 DSMAX=0.3 UZR={}");
  check_branches(workspace, "p72");
  run_to_grazing_curve(workspace);
  workspace.run("-c impacting_18901 -s grazing_curve -o p89 NMX=4");
  workspace.run("-c impacting_18901 -s p89 -o q89 IRS=EP1 --both GRSTOP=0 NPR=1 NMX=150 RL0=1 RL1=6");
  check_branches(workspace, "q89");
}

TEST_CASE("the fold beyond grazing at omega = 2.0072 is one: alpha(v) turns there") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o back DS=-0.02 GRSTOP=0 NMX=60");
  const SolutionEntry fold = only(workspace, "back", "LP");
  const double v = fold.states.back().at(1);
  CHECK(v < 0.0);
  const auto alpha = [](double velocity) { return ImpactingOrbit(velocity, 2.0072, zeta, restitution).alpha(); };
  CHECK(std::abs(fold.parameter(1) - alpha(v)) < 1e-8);
  // Zero of d alpha/d v by bisection.
  const auto slope = [&](double velocity) { return (alpha(velocity + 1e-5) - alpha(velocity - 1e-5)) / 2e-5; };
  double low = v - 0.05, high = v + 0.05;
  REQUIRE(slope(low) * slope(high) < 0.0);
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (slope(middle) * slope(low) > 0.0 ? low : high) = middle;
  }
  CHECK(std::abs(low - v) < 1e-4);
  CHECK(std::abs(alpha(low) - fold.parameter(1)) < 1e-7);
}

TEST_CASE("the doubled orbit, with both signs of DS, through impact velocity zero") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  // The first point of a switch has no label: steps short enough for another one before the first special point.
  for (const char* ds : {"0.002", "-0.002", "0.03"}) {
    INFO("DS = " << ds);
    workspace.run(std::string("-c doubled -s impacting_20072 -o doubled GRSTOP=0 NPR=1 NMX=150 RL0=1 RL1=6 DS=") + ds);
    check_branches(workspace, "doubled");
  }
}

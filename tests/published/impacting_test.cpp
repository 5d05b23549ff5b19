// The impacting orbit born at grazing: fold, period doubling, stability, and the orbit of twice the period.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/closed_forms.hpp"
#include "motion/orbit_flow.hpp"
#include "published/chain.hpp"
#include "support/linear_oscillator.hpp"

using namespace test_support;

namespace {

/// Velocity before the impact that ends segment s.
double velocity(const SolutionEntry& solution, std::size_t s = 0) { return solution.states.back().at(4 * s + 1); }

Eigen::Vector4d start_of(const SolutionEntry& solution) { return Eigen::Vector4d::Map(solution.states.front().data()); }

/// PT is negative up to and with the located point, positive after it, or the other way round.
void check_stability(const Workspace& workspace, const std::string& name, int label, bool stable_before) {
  const auto section = workspace.points(name).front();
  bool before = true;
  for (const PointRow& row : section.rows) {
    INFO("point " << row.point);
    if (row.point != 1) CHECK((row.point < 0) == (before == stable_before));
    if (row.label == label) before = false;
  }
  CHECK_FALSE(before);
}

/// Back from the last label, DS < 0 whatever sign the run to it had: the same point.
void check_backwards(const Workspace& workspace, const std::string& name, const std::string& type, double alpha) {
  const int last = workspace.solutions(name).back().label;
  workspace.run("-c " + name + " -s " + name + " -o back RL1=4 GRSTOP=1 DS=-0.02 IRS=" + std::to_string(last));
  CHECK(std::abs(only(workspace, "back", type).parameter(1) - alpha) < 1e-7);
}

}  // namespace

TEST_CASE("period doubling at omega = 2.0072, from the grazing curve's label") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  const SolutionEntry doubling = only(workspace, "impacting_20072", "PD");
  CHECK(of_type(read_diagnostics(workspace.read("d.impacting_20072")), "LP").empty());
  CHECK(doubling.parameter(2) == Approx(2.0072).epsilon(1e-10));
  CHECK(std::abs(doubling.parameter(1) - 3.03619356554716) < 1e-7);
  CHECK(std::abs(velocity(doubling) - 0.033243892548135) < 1e-6);
  CHECK(std::abs(ImpactingOrbit(velocity(doubling), 2.0072, zeta, restitution).alpha() - doubling.parameter(1)) < 1e-8);
  const auto point = with_label(read_diagnostics(workspace.read("d.impacting_20072")), doubling.label);
  CHECK(distance_to(point.multipliers, -1.0) < 1e-6);
  CHECK(distance_to(point.multipliers, -0.467984805) < 1e-6);
  check_stability(workspace, "impacting_20072", doubling.label, false);
  check_backwards(workspace, "impacting_20072", "PD", 3.03619356554716);
}

TEST_CASE("fold at omega = 1.8901, from the grazing curve's label") {
  const Workspace workspace;
  run_impacting(workspace, "18901");
  const SolutionEntry fold = only(workspace, "impacting_18901", "LP");
  CHECK(of_type(read_diagnostics(workspace.read("d.impacting_18901")), "PD").empty());
  CHECK(fold.parameter(2) == Approx(1.8901).epsilon(1e-10));
  CHECK(std::abs(fold.parameter(1) - 1.9706026714368) < 1e-7);
  CHECK(std::abs(velocity(fold) - 5.1987423726031) < 1e-5);  // of a parabola's top
  const auto point = with_label(read_diagnostics(workspace.read("d.impacting_18901")), fold.label);
  CHECK(distance_to(point.multipliers, 1.0) < 1e-6);
  CHECK(distance_to(point.multipliers, 0.45899627657) < 1e-6);
  check_stability(workspace, "impacting_18901", fold.label, false);
  check_backwards(workspace, "impacting_18901", "LP", 1.9706026714368);
}

TEST_CASE("a user value just before a fold is met on both sides of it") {
  const Workspace workspace;
  run_impacting(workspace, "18901");
  const double fold = only(workspace, "impacting_18901", "LP").parameter(1);
  // 1.9707 lies between the fold and both ends of the step that passes it; so do the others, at other distances.
  for (const double distance : {fold - 1.9707, 1e-4, 1e-6}) {
    const double value = fold + (fold < 1.9707 ? 1.0 : -1.0) * std::abs(distance);
    workspace.run(
        {"-c", "impacting_18901", "-s", "grazing_curve", "-o", "user", fmt::format("UZR={{1: [{:.15g}]}}", value)});
    std::string types;
    for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d.user")))
      if (point.type == "LP" || point.type == "UZ") types += point.type + " ";
    CAPTURE(distance);
    CHECK(types == "UZ LP UZ ");
  }
}

TEST_CASE("fold and period doubling on other meshes and with other steps") {
  const Workspace workspace;
  run_to_grazing_curve(workspace);
  struct Variant {
    const char* changes;
    double tolerance;
  };
  for (const Variant& v :
       {Variant{"NTST=100", 1e-7}, Variant{"NTST=200 NCOL=5", 1e-7}, Variant{"NCOL=6", 1e-7},
        Variant{"NTST=20 NCOL=3", 1e-5}, Variant{"DSMAX=0.05 NMX=600", 1e-7}, Variant{"DSMAX=10", 1e-7}}) {
    INFO(v.changes);
    workspace.run(std::string("-c impacting_20072 -s grazing_curve -o pd ") + v.changes + " RL1=3.05");
    CHECK(std::abs(only(workspace, "pd", "PD").parameter(1) - 3.03619356554716) < v.tolerance);
    workspace.run(std::string("-c impacting_18901 -s grazing_curve -o lp ") + v.changes + " RL1=2.6");
    CHECK(std::abs(only(workspace, "lp", "LP").parameter(1) - 1.9706026714368) < v.tolerance);
  }
}

TEST_CASE("the doubled orbit: two impacts a period, born with the squared multipliers, the same by integration") {
  const Workspace workspace;
  run_impacting(workspace, "20072");
  // At birth, in steps of 1e-4 and twice as much: multipliers 1 and 0.467984805^2, left quadratically.
  double left[2];
  for (int k : {0, 1}) {
    workspace.run(std::string("-c doubled -s impacting_20072 -o birth NMX=1 DS=") + (k == 0 ? "1e-4" : "2e-4"));
    const auto multipliers = read_diagnostics(workspace.read("d.birth")).front().multipliers;
    REQUIRE(multipliers.size() == 4);
    left[k] = distance_to(multipliers, 1.0);
    CHECK(distance_to(multipliers, 0.467984805 * 0.467984805) < 1e-3);
  }
  CHECK(left[0] < 1e-3);
  CHECK(left[1] / left[0] == Approx(4.0).margin(0.2));

  workspace.run("-c doubled -s impacting_20072 -o doubled NPR=1");
  const tchat::Signature signature{{1, 1, 1}, {1, 1, 1}};
  const auto points = read_diagnostics(workspace.read("d.doubled"));
  const auto solutions = workspace.solutions("doubled");
  int compared = 0;
  for (const SolutionEntry& solution : solutions) {
    INFO("label " << solution.label << ", alpha = " << solution.parameter(1));
    CHECK(solution.states.front().size() == 8);
    CHECK(solution.parameter(1) < 3.03619356554716);
    CHECK(solution.parameter(61) + solution.parameter(62) == Approx(4.0 * M_PI / 2.0072).epsilon(1e-9));
    CHECK(std::abs(velocity(solution, 0) - velocity(solution, 1)) > 1e-5);
    if (solution.internal.at(0) == 4.0) continue;  // grazing: no derivative of the map
    Eigen::VectorXd par = Eigen::VectorXd::Zero(4);
    for (int i = 0; i < 4; ++i) par(i) = solution.parameter(i + 1);
    const tchat::PeriodicOrbit orbit = tchat::shoot(tchat::test::linosc(), signature, start_of(solution), par);
    REQUIRE(orbit.converged);
    CHECK((orbit.start - start_of(solution)).norm() < 1e-8);
    CHECK(orbit.map.segments[0].duration == Approx(solution.parameter(61)).epsilon(1e-8));
    CHECK(orbit.map.segments[1].end(1) == Approx(velocity(solution, 1)).margin(1e-8));
    const auto& multipliers = with_label(points, solution.label).multipliers;
    for (const std::complex<double> mu : orbit.map.multipliers)
      CHECK(distance_to(multipliers, mu) < 1e-5 * (1.0 + std::abs(mu)));  // near the doubling a sensitive number
    ++compared;
  }
  CHECK(compared > 10);
  // One of the two impacts ends by grazing; a period doubling lies between, where a multiplier is -1 by integration.
  CHECK(points.back().type == "GR");
  CHECK(distance_to(with_label(points, only(workspace, "doubled", "PD").label).multipliers, -1.0) < 1e-6);
}

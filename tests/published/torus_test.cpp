// Langford's system: the torus bifurcation in closed form, its curve in two parameters, and one without symmetry.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "../../problems/langford/langford.cpp"
#include "motion/orbit_flow.hpp"
#include "published/chain.hpp"
#include "support/test_system.hpp"

using namespace test_support;

namespace {

constexpr double c = 0.6, d = 3.5, e = 0.25;

/// a on the curve: a = b^2 + e r^2 with r^2 = (c + a b - b^3/3) / (1 + e b).
double torus_a(double b) { return b * b * (1.0 + e * b) + e * (c - b * b * b / 3.0); }
double radius_squared(double a, double b) { return (c + a * b - b * b * b / 3.0) / (1.0 + e * b); }
/// Over one period 2 pi/d of the rotation.
double torus_angle(double b) { return 2.0 * M_PI / d * std::sqrt(2.0 * radius_squared(torus_a(b), b) * (1.0 + e * b)); }

void enter(const Workspace& workspace) {
  namespace fs = std::filesystem;
  fs::copy_file(LANGFORD_LIBRARY, workspace.file("langford.so"));
  for (const char* name : {"gc.langford", "langford.dat"})
    fs::copy_file(std::string(LANGFORD_CONSTANTS "/") + name, workspace.file(name));
}

void run(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("run langford " + arguments);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
}

const char* const curve = "-s langford -o curve IRS=TR1 ISW=2 ICP=[2,1,61] RL0=0.1 --both UZR={2:[0.3,0.5,0.9]}";

}  // namespace

TEST_CASE("torus bifurcation at its closed form") {
  const Workspace workspace;
  enter(workspace);
  for (const char* changes : {"", "NTST=100", "DSMAX=0.02 NMX=400", "NCOL=6"}) {
    INFO(changes);
    run(workspace, changes);
    const SolutionEntry torus = only(workspace, "langford", "TR");
    CHECK(torus.type == 8);
    CHECK(std::abs(torus.parameter(1) - torus_a(0.7)) < 1e-7);
    const auto point = with_label(read_diagnostics(workspace.read("d.langford")), torus.label);
    CHECK(distance_to(point.multipliers, std::polar(1.0, torus_angle(0.7))) < 1e-6);
  }
}

TEST_CASE("torus curve: the closed form in two parameters, multipliers on the unit circle") {
  const Workspace workspace;
  enter(workspace);
  run(workspace, "");
  run(workspace, curve);
  int points = 0;
  for (const PointSection& section : workspace.points("curve"))
    for (const PointRow& row : section.rows) {
      const double b = row.values[section.column("b")];
      INFO("b = " << b);
      CHECK(std::abs(row.values[section.column("a")] - torus_a(b)) < 1e-8);
      CHECK(row.values[section.column("PERIOD")] == Approx(2.0 * M_PI / d).epsilon(1e-9));
      ++points;
    }
  CHECK(points > 20);
  const auto solutions = workspace.solutions("curve");
  for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d.curve"))) {
    int on_circle = 0;
    for (const auto& mu : point.multipliers) on_circle += std::abs(std::abs(mu) - 1.0) < 1e-8 ? 1 : 0;
    CHECK(on_circle == 2);
    if (point.label == 0 || point.type.empty()) continue;
    const double b = with_label(solutions, point.label).parameter(2);
    CHECK(distance_to(point.multipliers, std::polar(1.0, torus_angle(b))) < 1e-6);
  }
  int met = 0;
  for (const SolutionEntry& solution : solutions)
    for (const double b : {0.3, 0.5, 0.9})
      if (std::abs(solution.parameter(2) - b) < 1e-8) {
        CHECK(solution.type == -84);
        ++met;
      }
  CHECK(met == 3);
}

TEST_CASE("torus curve of a fixed angle in three parameters: the closed form, from TR and from a 1:3 resonance") {
  const Workspace workspace;
  enter(workspace);
  run(workspace, "EPSS=1e-10");
  run(workspace, std::string(curve) + " EPSS=1e-10");
  // By d the angle over a period is 2 pi / d sqrt(2 r^2 (1 + e b)); the a of the curve does not depend on d.
  const auto angle = [](double b, double turn) { return torus_angle(b) * d / turn; };
  struct Start {
    const char* label;
    double angle;
  };
  for (const Start& start : {Start{"langford IRS=TR1", torus_angle(0.7)}, Start{"curve IRS=R31", 2.0 * M_PI / 3.0}}) {
    INFO(start.label);
    run(workspace,
        std::string("-o fixed ISW=3 ICP=[2,1,4,61] RL0=0.1 RL1=2 --both NMX=40 NPR=5 DSMAX=0.2 -s ") + start.label);
    int points = 0;
    for (const PointSection& section : workspace.points("fixed"))
      for (const PointRow& row : section.rows) {
        const double b = row.values[section.column("b")], turn = row.values[section.column("d")];
        INFO("b = " << b);
        CHECK(std::abs(row.values[section.column("a")] - torus_a(b)) < 1e-8);
        CHECK(std::abs(angle(b, turn) - start.angle) < 1e-8);
        ++points;
      }
    CHECK(points > 40);
    for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d.fixed")))
      CHECK(distance_to(point.multipliers, std::polar(1.0, start.angle)) < 1e-7);
    for (const SolutionEntry& stored : workspace.solutions("fixed")) {
      INFO("label " << stored.label);
      run(workspace, "-c r.fixed -s fixed -o again NMX=1 IRS=" + std::to_string(stored.label));
      CHECK(first_iterations(workspace.read("d.again")) <= 1);
      CHECK(difference(stored, workspace.solutions("again").front()) < 2e-10);
    }
  }
  const Outcome refused = workspace.tchat("run langford -s langford -o refused IRS=EP1 ISW=3 ICP=[2,1,4]");
  CHECK(refused.status != 0);
  CHECK(refused.text().find("torus bifurcations of the start's angle in three parameters (TR)") != std::string::npos);
}

TEST_CASE("torus bifurcation without symmetry: the multipliers by integration") {
  const Workspace workspace;
  enter(workspace);
  run(workspace, "PAR(f)=0.1");
  const SolutionEntry torus = only(workspace, "langford", "TR");
  CHECK(std::abs(torus.parameter(1) - torus_a(0.7)) > 1e-5);
  Eigen::VectorXd par(6);
  for (int k = 0; k < 6; ++k) par(k) = torus.parameter(k + 1);
  const Eigen::Vector3d start = Eigen::Vector3d::Map(torus.states.front().data());
  const tchat::PeriodicOrbit orbit = tchat::shoot(tchat::test::system_of<Langford>(), {{1, 1, 1}}, start, par);
  REQUIRE(orbit.converged);
  CHECK((orbit.start - start).norm() < 1e-8);
  CHECK(std::abs(std::abs(orbit.map.multipliers(0)) - 1.0) < 1e-6);
  CHECK(std::abs(orbit.map.multipliers(0).imag()) > 0.1);
}

TEST_CASE("every label of the torus branch and curve restarts with at most one Newton step") {
  const Workspace workspace;
  enter(workspace);
  run(workspace, "NPR=3");
  run(workspace, std::string(curve) + " NPR=3");
  for (const std::string name : {"langford", "curve"})
    for (const SolutionEntry& stored : workspace.solutions(name)) {
      INFO(name << " label " << stored.label);
      run(workspace, "-c r." + name + " -s " + name + " -o again NMX=1 IRS=" + std::to_string(stored.label));
      CHECK(first_iterations(workspace.read("d.again")) <= 1);
      CHECK(difference(stored, workspace.solutions("again").front()) < 2e-10);
    }
}

// Fold and period-doubling curves of the linear oscillator: values, their end on the grazing curve, the contact there.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/chain.hpp"

using namespace test_support;

namespace {

struct Value {
  double alpha, omega;
};

struct Curve {
  std::string name, start;
  std::vector<Value> values;  // by shooting
  double coefficient;         // of (omega - 2 omega_d)^2 in alpha - alpha_grazing
  int curve_type;
  double largest_step;  // DSMAX of its constants file
};

const Curve folds{"fold_curve",
                  "impacting_18901",
                  {{1.25439760038614, 1.8}, {2.40313792491044, 1.93}, {2.89754367156341, 1.98}},
                  -101.847,
                  5,
                  0.5};
const Curve doublings{"period_doubling_curve",
                      "impacting_20072",
                      {{3.0270895153509, 2.005}, {3.2307920852107, 2.05}, {3.50618844784601, 2.1}},
                      7.32254,
                      7,
                      0.1};

double codimension_two() { return 2.0 * std::sqrt(1.0 - zeta * zeta); }
double grazing_alpha(double omega) { return std::hypot(1.0 - omega * omega, 2.0 * zeta * omega); }

void run_curve(const Workspace& workspace, const Curve& curve, const std::string& options, const std::string& name) {
  workspace.run("-c " + curve.name + " -s " + curve.start + " --both -o " + name + options);
}

void check_values(const Workspace& workspace, const Curve& curve, const std::string& name) {
  const auto solutions = workspace.solutions(name);
  for (const Value& value : curve.values) {
    INFO("omega = " << value.omega);
    const auto found = std::find_if(solutions.begin(), solutions.end(), [&](const SolutionEntry& s) {
      return std::abs(s.parameter(2) - value.omega) < 1e-7 && std::abs(s.parameter(1) - value.alpha) < 1e-2;
    });
    REQUIRE(found != solutions.end());
    CHECK(found->type == -(10 * curve.curve_type + 4));
    CHECK(std::abs(found->parameter(2) - value.omega) < 1e-8);
    CHECK(std::abs(found->parameter(1) - value.alpha) < 1e-7);
  }
}

void check_multipliers(const Workspace& workspace, const Curve& curve, const std::string& name) {
  const double critical = curve.curve_type == 5 ? 1.0 : -1.0;
  for (const DiagnosticPoint& point : read_diagnostics(workspace.read("d." + name))) {
    INFO("branch " << point.branch << " point " << point.point);
    CHECK(distance_to(point.multipliers, critical) < 1e-6);
  }
}

/// Where the curve ends on the grazing curve, multipliers are 0/0. What is printed there is right: the critical one,
/// and of the others only what is near one of the point before; what is missing is counted.
void check_end_multipliers(const Workspace& workspace, const std::string& name) {
  const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d." + name));
  const auto end = std::find_if(points.begin(), points.end(), [](const DiagnosticPoint& p) { return p.type == "GR"; });
  REQUIRE(end != points.end());
  REQUIRE(end != points.begin());
  const DiagnosticPoint& before = *(end - 1);
  REQUIRE(before.branch == end->branch);
  REQUIRE(before.multipliers.size() == 4);
  const double critical = distance_to(before.multipliers, 1.0) < 1e-4 ? 1.0 : -1.0;
  CHECK(distance_to(end->multipliers, critical) < 1e-9);
  for (const auto& mu : end->multipliers) {
    INFO("multiplier " << mu.real() << " " << mu.imag());
    CHECK(distance_to(before.multipliers, mu) < 1e-2);
  }
  int missing = 0;
  for (const std::string& note : end->notes) {
    if (note.find("one multiplier is not determined") != std::string::npos) missing = 1;
    if (const auto at = note.find(" multipliers are not determined"); at != std::string::npos)
      missing = std::stoi(note.substr(note.rfind(' ', at - 1) == std::string::npos ? 0 : note.rfind(' ', at - 1)));
  }
  CHECK(static_cast<int>(end->multipliers.size()) + missing == 4);
  CHECK(missing >= 1);
}

void check_codimension_two_point(const Workspace& workspace, const std::string& name, double tolerance = 1e-7) {
  const SolutionEntry end = only(workspace, name, "GR");
  CHECK(std::abs(end.parameter(2) - codimension_two()) < tolerance);
  CHECK(std::abs(end.parameter(1) - 2.9966648127543) < 4.0 * tolerance);  // along the grazing curve
  CHECK(end.internal.at(0) == 4.0);
}

/// Steps of at most 0.0005 from near the end: the distance to the grazing curve is quadratic.
void check_contact(const Workspace& workspace, const Curve& curve, const std::string& name) {
  std::vector<double> x, y;
  for (const PointSection& section : workspace.points(name))
    for (const PointRow& row : section.rows) {
      const double omega = row.values[section.column("omega")];
      const double distance = std::abs(omega - codimension_two());
      if (distance < 2e-4 || distance > 6e-3) continue;
      const double contact = row.values[section.column("alpha")] - grazing_alpha(omega);
      CHECK(contact * curve.coefficient > 0.0);
      x.push_back(std::log(distance));
      y.push_back(std::log(std::abs(contact)));
    }
  REQUIRE(x.size() >= 5);
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
  const double count = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) mx += x[i] / count, my += y[i] / count;
  for (std::size_t i = 0; i < x.size(); ++i) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
  CHECK(xy / xx == Approx(2.0).margin(0.1));
  // The coefficient, from the nearest point.
  const auto nearest = static_cast<std::size_t>(std::min_element(x.begin(), x.end()) - x.begin());
  CHECK(std::exp(y[nearest] - 2.0 * x[nearest]) == Approx(std::abs(curve.coefficient)).epsilon(0.03));
}

void check_curve(const Workspace& workspace, const Curve& curve) {
  INFO(curve.name);
  run_impacting(workspace, curve.start.substr(10));
  run_curve(workspace, curve, "", "curve");
  check_values(workspace, curve, "curve");
  check_multipliers(workspace, curve, "curve");
  check_codimension_two_point(workspace, "curve");
  check_end_multipliers(workspace, "curve");
  const auto sections = workspace.points("curve");
  const PointRow& last = *std::find_if(sections.begin(), sections.end(), [](const PointSection& s) {
                            return std::abs(s.rows.back().values.front() - codimension_two()) < 1e-6;
                          })->rows.rbegin();
  CHECK(last.type == -(10 * curve.curve_type + 4));  // the curve ends there
}

void check_passage(const Workspace& workspace, const Curve& curve) {
  INFO(curve.name);
  run_impacting(workspace, curve.start.substr(10));
  run_curve(workspace, curve, " GRSTOP=0 DSMAX=0.02 NMX=400", "through");
  check_values(workspace, curve, "through");
  check_codimension_two_point(workspace, "through");
  check_multipliers(workspace, curve, "through");
  // It runs on beyond, into orbits that the model forbids.
  const auto sections = workspace.points("through");
  const PointRow* beyond = nullptr;
  for (const PointSection& section : sections) {
    const auto met = std::find_if(section.rows.begin(), section.rows.end(), [](const PointRow& row) {
      return std::abs(row.values.front() - codimension_two()) < 1e-6;
    });
    if (met != section.rows.end() && section.rows.end() - met > 5) beyond = &section.rows.back();
  }
  REQUIRE(beyond != nullptr);
  const double omega = beyond->values.front();
  CHECK((omega - codimension_two()) * (curve.values.front().omega - codimension_two()) < 0.0);
}

/// The same end on other meshes and with steps 20 times smaller and larger.
void check_robustness(const Workspace& workspace, const Curve& curve) {
  INFO(curve.name);
  run_impacting(workspace, curve.start.substr(10));
  struct Variant {
    std::string changes;
    double tolerance;
  };
  const std::string smaller = " NMX=2000 DSMAX=" + std::to_string(curve.largest_step / 20.0);
  const std::string larger = " DSMAX=" + std::to_string(curve.largest_step * 20.0);
  for (const Variant& v :
       {Variant{" NTST=50 NCOL=6", 1e-7}, Variant{" NTST=100", 1e-7}, Variant{" NTST=200 NCOL=5", 1e-7},
        Variant{" NTST=20 NCOL=3", 1e-5}, Variant{smaller, 1e-7}, Variant{larger, 1e-7}}) {
    INFO(v.changes);
    run_curve(workspace, curve, v.changes, "curve");
    check_codimension_two_point(workspace, "curve", v.tolerance);
    check_end_multipliers(workspace, "curve");
  }
}

/// Back from the point itself, in small steps.
void check_quadratic(const Workspace& workspace, const Curve& curve) {
  INFO(curve.name);
  run_impacting(workspace, curve.start.substr(10));
  run_curve(workspace, curve, "", "curve");
  workspace.run("-c " + curve.name + " -s curve -o near IRS=GR1 --both GRSTOP=0 DS=0.0003 DSMAX=0.003 NMX=40");
  check_contact(workspace, curve, "near");
}

}  // namespace

TEST_CASE("fold curve to its end on the grazing curve") { check_curve(Workspace(), folds); }
TEST_CASE("period-doubling curve to its end on the grazing curve") { check_curve(Workspace(), doublings); }
TEST_CASE("fold curve through the grazing curve") { check_passage(Workspace(), folds); }
TEST_CASE("period-doubling curve through the grazing curve") { check_passage(Workspace(), doublings); }
TEST_CASE("fold curve: quadratic contact with the grazing curve") { check_quadratic(Workspace(), folds); }
TEST_CASE("period-doubling curve: quadratic contact with the grazing curve") {
  check_quadratic(Workspace(), doublings);
}

TEST_CASE("fold curve: its end on other meshes and with other steps") { check_robustness(Workspace(), folds); }
TEST_CASE("period-doubling curve: its end on other meshes and with other steps") {
  check_robustness(Workspace(), doublings);
}

TEST_CASE("the dissertation's two runs: a restart with ISW 2 from a label of the curve") {
  const Workspace workspace;
  run_impacting(workspace, "18901");
  workspace.run("-c fold_curve -s impacting_18901 -o first NMX=2");
  workspace.run("-c fold_curve -s first -o second --both IRS=" +
                std::to_string(workspace.solutions("first").back().label));
  check_values(workspace, folds, "second");
  check_codimension_two_point(workspace, "second");
}

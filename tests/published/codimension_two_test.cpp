// Points of codimension two on curves of orbits, and the curves that meet there, of maps in closed form: the map is the
// jump of a clock.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

#include "published/chain.hpp"

using namespace test_support;

namespace {

constexpr double accuracy = 1e-8;  // of located points and of what is on curves: EPSS = 1e-9 on the arclength

/// `head`: parameters, names and the rest of the states between jumps; `jump`: what becomes of them once in a unit of
/// time. The parameters p and q come first.
void simulate(const Workspace& workspace, const std::string& head, const std::string& jump) {
  workspace.write("map.tch", head + "phi' = 1\nevent turn = 1 - phi\njump back: " + jump +
                                 ", phi -> phi - 1\nafter any: turn -> back\n");
  workspace.succeed("simulate map --free p -o map --dat -q");
  workspace.succeed("run map -d map -c map -o up DS=0.01 DSMAX=0.02 NMX=60 RL1=0.1 -q");
  workspace.succeed("run map -d map -c map -o down DS=-0.01 DSMAX=0.02 NMX=60 RL0=-1 -q");
}

/// A curve in p and q from a label of NAME, in the direction `ds` of q as long as |q| < 0.5.
void follow(const Workspace& workspace, const std::string& name, const std::string& from, const std::string& label,
            const std::string& ds, const std::string& words = "") {
  workspace.succeed("run map -q -c r." + from + " -s " + from + " -o " + name + " ISW=2 ICP=[q,p] IRS=" + label +
                    " DS=" + ds + " DSMAX=0.02 NMX=100 NPR=1 CUBIC=1 RL0=-0.5 RL1=0.5 " + words);
}

/// The label of that type is at (p, q).
void check_place(const Workspace& workspace, const std::string& name, const std::string& type, double p, double q) {
  INFO(name << " " << type);
  const SolutionEntry label = only(workspace, name, type);
  CHECK(std::abs(label.parameter(1) - p) < accuracy);
  CHECK(std::abs(label.parameter(2) - q) < accuracy);
}

/// All points of the curve are at (p(q), q), and some on both sides of q = 0 where `both` says so.
void check_curve(const Workspace& workspace, const std::string& name, const std::function<double(double)>& p) {
  const std::vector<SolutionEntry> points = workspace.solutions(name);
  REQUIRE(points.size() > 10);
  for (const SolutionEntry& point : points) {
    INFO(name << " at q = " << point.parameter(2));
    CHECK(std::abs(point.parameter(1) - p(point.parameter(2))) < accuracy);
  }
}

/// A fold at p = 0, x = 0, and a multiplier of modulus 1 + q + k x for the other states: critical at x = -q / k, p =
/// -(q / k)^2. This curve touches that of folds at q = 0.
constexpr double k = 0.7;
double touching(double q) { return -(q / k) * (q / k); }
double folds(double) { return 0.0; }

constexpr const char* pair = "y -> m*(cos(1.1)*y - sin(1.1)*z), z -> m*(sin(1.1)*y + cos(1.1)*z)";

}  // namespace

TEST_CASE("curves of folds and of period doublings touch at LPD, from which both are followed") {
  const Workspace workspace;
  simulate(workspace, "par p=-0.1, q=0.3, k=0.7\ninit x=-0.31, y=0\nx' = 0\ny' = 0\n",
           "x -> x + p + x^2 + y^2/5, y -> -(1+q+k*x)*y + y^3");
  follow(workspace, "folds", "up", "LP1", "-0.02");
  check_place(workspace, "folds", "LPD", 0.0, 0.0);
  check_curve(workspace, "folds", folds);
  follow(workspace, "doublings", "down", "PD1", "-0.02");
  check_place(workspace, "doublings", "LPD", 0.0, 0.0);
  check_curve(workspace, "doublings", touching);
  follow(workspace, "other", "folds", "LPD1", "0.02", "CURVE=PD");
  check_curve(workspace, "other", touching);
  follow(workspace, "other", "doublings", "LPD1", "0.02", "CURVE=LP");
  check_curve(workspace, "other", folds);
}

TEST_CASE("curves of folds and of torus bifurcations touch at LTR, from which both are followed") {
  const Workspace workspace;
  simulate(workspace,
           "par p=-0.1, q=0.3, k=0.7\ninit x=-0.31, y=0, z=0\nm = 1 + q + k*x - y^2 - z^2\nx' = 0\ny' = 0\nz' = 0\n",
           std::string("x -> x + p + x^2, ") + pair);
  follow(workspace, "folds", "up", "LP1", "-0.02");
  check_place(workspace, "folds", "LTR", 0.0, 0.0);
  check_curve(workspace, "folds", folds);
  follow(workspace, "tori", "down", "TR1", "-0.02");
  check_place(workspace, "tori", "LTR", 0.0, 0.0);
  check_curve(workspace, "tori", touching);
  follow(workspace, "other", "folds", "LTR1", "0.02", "CURVE=TR");
  check_curve(workspace, "other", touching);
  follow(workspace, "other", "tori", "LTR1", "0.02", "CURVE=LP");
  check_curve(workspace, "other", folds);
}

TEST_CASE("curves of period doublings and of torus bifurcations cross at PTR, from which both are followed") {
  const Workspace workspace;
  simulate(workspace, "par p=-0.3, q=-0.3\ninit x=0, y=0, z=0\nm = 1 + q + 0.7*p - y^2 - z^2\nx' = 0\ny' = 0\nz' = 0\n",
           std::string("x -> -(1+p-0.4*q)*x + x^3, ") + pair);
  const auto doublings = [](double q) { return 0.4 * q; };
  const auto tori = [](double q) { return -q / 0.7; };
  follow(workspace, "doublings", "up", "PD1", "0.02");
  check_place(workspace, "doublings", "PTR", 0.0, 0.0);
  check_curve(workspace, "doublings", doublings);
  follow(workspace, "tori", "doublings", "PTR1", "0.02", "CURVE=TR");
  check_curve(workspace, "tori", tori);
  follow(workspace, "tori", "tori", "EP1", "-0.02", "CURVE=");
  check_place(workspace, "tori", "PTR", 0.0, 0.0);
  check_curve(workspace, "tori", tori);
}

TEST_CASE("two curves of torus bifurcations cross at TTR") {
  const Workspace workspace;
  simulate(workspace,
           "par p=-0.3, q=-0.3\ninit u=0, v=0, y=0, z=0\nm = 1 + q + 0.7*p - y^2 - z^2\nl = 1 + p - 0.4*q - u^2 - v^2\n"
           "u' = 0\nv' = 0\ny' = 0\nz' = 0\n",
           std::string("u -> l*(cos(2)*u - sin(2)*v), v -> l*(sin(2)*u + cos(2)*v), ") + pair);
  follow(workspace, "tori", "up", "TR1", "0.02");
  check_place(workspace, "tori", "TTR", 0.0, 0.0);
  check_curve(workspace, "tori", [](double q) { return 0.4 * q; });
}

TEST_CASE("generalised period doubling, and the folds of doubled orbits that begin there") {
  // x -> -(1 + p) x + q x^3 + x^5: c = q; doubled orbits, x -> -x, have p = q x^2 + x^4, and folds at p = -q^2 / 4, q <
  // 0.
  const Workspace workspace;
  simulate(workspace, "par p=-0.3, q=-0.3\ninit x=0\nx' = 0\n", "x -> -(1+p)*x + q*x^3 + x^5");
  follow(workspace, "doublings", "up", "PD1", "0.02");
  check_place(workspace, "doublings", "GPD", 0.0, 0.0);
  check_curve(workspace, "doublings", [](double) { return 0.0; });
  workspace.succeed("run map -q -c r.up -s up -o doubled IRS=PD1 ISW=-1 DS=0.01 DSMAX=0.02 NMX=40 RL0=-0.5");
  follow(workspace, "folds", "doubled", "LP1", "0.02");
  const std::vector<SolutionEntry> points = workspace.solutions("folds");
  REQUIRE(points.size() > 10);
  for (const SolutionEntry& point : points) {
    INFO(point.parameter(2));
    CHECK(std::abs(point.parameter(1) + 0.25 * std::pow(point.parameter(2), 2)) < accuracy);
    CHECK(point.parameter(2) < accuracy);
  }
}

TEST_CASE("Chenciner point: the torus bifurcation is neither super- nor subcritical") {
  // The modulus is multiplied by 1 + p + q r^2 - r^4: Re d has the sign of q.
  const Workspace workspace;
  simulate(workspace,
           "par p=-0.3, q=-0.3\ninit y=0, z=0\nr = y^2 + z^2\nm = 1 + p + q*r - r^2\na = 1.1 + 0.3*r\ny' = 0\nz' = 0\n",
           "y -> m*(cos(a)*y - sin(a)*z), z -> m*(sin(a)*y + cos(a)*z)");
  follow(workspace, "tori", "up", "TR1", "0.02");
  check_place(workspace, "tori", "CH", 0.0, 0.0);
  check_curve(workspace, "tori", [](double) { return 0.0; });
}

// Coefficients. Return maps of the states at the start of the clock's turn, in closed form; formulas of a, b, c, d by
// hand.

namespace {

double printed(const Workspace& workspace, const std::string& name, const std::string& type,
               const std::string& coefficient) {
  const std::vector<DiagnosticPoint> points = of_type(read_diagnostics(workspace.read("d." + name)), type);
  REQUIRE(points.size() == 1);
  for (const std::string& note : points.front().notes) {
    const std::size_t at = note.find(coefficient + " = ");
    if (at != std::string::npos) return std::stod(note.substr(at + coefficient.size() + 3));
  }
  INFO(workspace.read("d." + name));
  FAIL("no " << coefficient);
  return NAN;
}

constexpr double coefficient_accuracy = 1e-6;  // the point is located to 1e-9 on the arclength, slopes are of size 10

}  // namespace

TEST_CASE("the coefficient of a cusp") {
  // p + q x + 0.4 x^2 y + 0.7 x^3 more each time, y -> y / 2 + 0.6 x^2: y = 1.2 x^2 on the centre manifold.
  const Workspace workspace;
  simulate(workspace, "par p=-0.3, q=-0.3\ninit x=-0.6, y=0\nx' = 0\ny' = 0\n",
           "x -> x + p - 0.7*x^3 + q*x - 0.4*x*y, y -> y/2 + 0.6*x^2");
  workspace.succeed("run map -d map -c map -o fold 'PAR(q)=0.5' DS=-0.01 DSMAX=0.02 NMX=200 RL0=-1 -q STOP=[LP1]");
  follow(workspace, "folds", "fold", "LP1", "-0.02");
  check_place(workspace, "folds", "CP", 0.0, 0.0);
  CHECK(printed(workspace, "folds", "CP", "c") == Approx(-0.7 - 0.4 * 1.2).margin(coefficient_accuracy));
}

TEST_CASE("coefficients of the 1:2 resonance") {
  // (x, y) -> (-x + y, -(1 + p) y + q x + c x^3 + d x^2 y + e x^2): c + e^2 / 2 and d + e^2.
  const Workspace workspace;
  simulate(workspace, "par p=-0.3, q=0.1\ninit x=0, y=0\nx' = 0\ny' = 0\n",
           "x -> -x + y, y -> -(1+p)*y + q*x + 0.3*x^3 + 0.5*x^2*y + 0.2*x^2");
  workspace.succeed("run map -d map -c map -o down 'PAR(q)=-0.05' ICP=[q] DS=0.01 DSMAX=0.02 NMX=60 RL1=0.5 -q");
  follow(workspace, "doublings", "down", "PD1", "0.02", "ICP=[p,q]");
  check_place(workspace, "doublings", "R2", 0.0, 0.0);
  CHECK(printed(workspace, "doublings", "R2", "c") == Approx(0.3 + 0.02).margin(coefficient_accuracy));
  CHECK(printed(workspace, "doublings", "R2", "d") == Approx(0.5 + 0.04).margin(coefficient_accuracy));
}

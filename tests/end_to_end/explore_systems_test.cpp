// tchat explore of textbook systems, one command each: every attractor on a branch, and special points that are known
// in closed form or from the characteristic polynomial.
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <regex>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// The parameter of the label of this type that is nearest to `value`.
double nearest(const std::string& tree, const std::string& type, double value) {
  double best = INFINITY;
  for (std::size_t at = tree.find(type + " "); at != std::string::npos; at = tree.find(type + " ", at + 1)) {
    double found = INFINITY;
    const bool is_label = std::sscanf(tree.c_str() + at, "%*s %*d at %lf", &found) == 1;
    if (is_label && std::abs(found - value) < std::abs(best - value)) best = found;
  }
  return best;
}

void check_label(const std::string& tree, const std::string& type, double value) {
  INFO(type << " in\n" << tree);
  CHECK(nearest(tree, type, value) == Approx(value).epsilon(1e-8));
}

/// The tree of an exploration, in which every attractor lies on a branch.
std::string explored(const Workspace& workspace, const std::string& source, const std::string& arguments) {
  if (!source.empty()) REQUIRE(workspace.shell("cp " + source + " .").status == 0);
  const Outcome outcome = workspace.tchat("explore " + arguments + " -o diagram -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("diagram.txt");
  INFO(tree);
  CHECK(tree.find("(100 %)") != std::string::npos);
  return tree;
}

/// The drill string at an equilibrium, where all of it turns at the speed w.
struct DrillString {
  double Ju = 0.47, bu = 2.42, k = 0.075, Jl = 0.035, Ts = 0.28, Tc = 0.047, ws = 1.43, bl = 0.0105;
  double stribeck(double w) const { return (Ts - Tc) * std::exp(-w * w / (ws * ws)); }
  double friction(double w) const { return Tc + stribeck(w) + bl * w; }
  double slope(double w) const { return -2.0 * w / (ws * ws) * stribeck(w) + bl; }
  double torque(double w) const { return bu * w + friction(w); }
  /// a2 a1 - a0 of the characteristic polynomial l^3 + a2 l^2 + a1 l + a0: zero at a Hopf bifurcation.
  double hurwitz(double w) const {
    const double u = bu / Ju, l = slope(w) / Jl;
    return (u + l) * (u * l + k / Ju + k / Jl) - (k / Ju * l + k / Jl * u);
  }
};

/// The membrane of Morris and Lecar at rest at the potential v, where its current is I(v).
struct Membrane {
  static double rise(double v, double half, double width) { return 0.5 * (1.0 + std::tanh((v - half) / width)); }
  static double slope(double v, double half, double width) {
    return 0.5 / width / std::pow(std::cosh((v - half) / width), 2);
  }
  static double current(double v) {
    return 2.0 * (v + 60.0) + 4.4 * rise(v, -1.2, 18.0) * (v - 120.0) + 8.0 * rise(v, 2.0, 30.0) * (v + 84.0);
  }
  /// Zero at a Hopf bifurcation.
  static double trace(double v) {
    const double calcium = slope(v, -1.2, 18.0) * (v - 120.0) + rise(v, -1.2, 18.0);
    return -(2.0 + 4.4 * calcium + 8.0 * rise(v, 2.0, 30.0)) / 20.0 - 0.04 * std::cosh((v - 2.0) / 60.0);
  }
  static double hopf_current(double low, double high) {
    std::uintmax_t iterations = 100;
    const auto root =
        boost::math::tools::toms748_solve(&trace, low, high, boost::math::tools::eps_tolerance<double>(50), iterations);
    return current(0.5 * (root.first + root.second));
  }
};

}  // namespace

TEST_CASE("the cycles between two Hopf bifurcations are one branch, from either end and from an attractor") {
  const Workspace workspace;
  REQUIRE(workspace.shell("cp " + std::string(SYSTEMS) + "/morris_lecar.tch .").status == 0);
  const Outcome outcome = workspace.tchat("explore morris_lecar --over I=60:250:39 -o diagram -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("diagram.txt");
  check_label(tree, "HB", Membrane::hopf_current(-40.0, -10.0));  // 93.86 in the book
  check_label(tree, "HB", Membrane::hopf_current(0.0, 20.0));     // 212.0
  CHECK(nearest(tree, "LP", 88.29) == Approx(88.29).margin(0.01));
  // Equilibria begin on either bound of the range, where one direction has no orbit: no branch of their own.
  CHECK(tree.find("\n2 branches. ") != std::string::npos);
}

TEST_CASE("predators and prey, a problem without jumps: equilibria, branch point, Hopf bifurcation, cycles") {
  const Workspace workspace;
  const std::string tree = explored(workspace, PREDATOR_SOURCE, "predator --over K=0.5:6:56 --state 0.5,0.3");
  // With d = 1/2: prey x = 1 with predators from K = 1 on, cycles from K = 3 on, the harvest begins at K = 5.
  check_label(tree, "BP", 1.0);
  check_label(tree, "HB", 3.0);
  check_label(tree, "BE", 5.0);
  check_label(tree, "GR", 3.050997322);  // problems/predator/Makefile
}

TEST_CASE("a smooth problem: the cycle of the Brusselator is found from its equilibrium and by simulation") {
  const Workspace workspace;
  workspace.write("brusselator.tch", "par A=1, B=1.5\ninit x=1.2, y=1\nx' = A - (B + 1)*x + x^2*y\ny' = B*x - x^2*y\n");
  const std::string tree = explored(workspace, "", "brusselator --over B=1.5:2.5:21");
  check_label(tree, "HB", 2.0);  // 1 + A^2
}

TEST_CASE("the neuron of Izhikevich: rest, fold and Hopf bifurcation, spikes") {
  const Workspace workspace;
  const std::string tree = explored(workspace, std::string(SYSTEMS) + "/izhikevich.tch", "izhikevich --over I=0:20:81");
  // 0.04 v^2 + (5 - b) v + 140 + I = 0 at rest; the trace 0.08 v + 5 - a is zero at v = -62.25.
  check_label(tree, "HB", 3.7975);
  check_label(tree, "LP", 4.0);
}

TEST_CASE("an oscillator between two walls grazes both where its amplitude reaches them") {
  const Workspace workspace;
  const std::string tree =
      explored(workspace, std::string(SYSTEMS) + "/two_walls.tch", "two_walls --over omega=1.3:1.6:31 --segments 8");
  // (1 - omega^2)^2 + (2 zeta omega)^2 = F^2 with F = 1.
  check_label(tree, "GR", std::sqrt(2.0 - 4.0 * 0.05 * 0.05));
}

TEST_CASE("a drill string: stick-slip beside steady rotation, which loses its stability in a Hopf bifurcation") {
  const Workspace workspace;
  const std::string tree =
      explored(workspace, std::string(SYSTEMS) + "/drill_string.tch", "drill_string --over torque=4:9:51");
  const DrillString drill;
  std::uintmax_t iterations = 100;
  const auto root = boost::math::tools::toms748_solve([&](double w) { return drill.hurwitz(w); }, 2.0, 4.0,
                                                      boost::math::tools::eps_tolerance<double>(50), iterations);
  check_label(tree, "HB", drill.torque(0.5 * (root.first + root.second)));
}

TEST_CASE("an impact that loses its velocity is followed to the orbit without it") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat("explore linosc --over alpha=2.5:3.5:51 PAR(omega)=2.0072 -o osc -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("osc.txt");
  INFO(tree);
  CHECK(tree.find("GR 4 at 3.035495345 -> b1") != std::string::npos);
  // Of the doubled orbit one of two impacts vanishes: one impact in two periods, born at a fold.
  CHECK(std::regex_search(tree, std::regex("GR 6 at [0-9.]+ -> b[0-9]+\n")));
}

TEST_CASE("an attractor that only further starts find begins a branch where its first segment ends") {
  const Workspace workspace;
  // The block rocks thrice as slowly as the ground shakes; at the corner the other field is as good a start.
  const std::string tree =
      explored(workspace, ROCKING_BLOCK, "rocking_block --over beta=1.045:1.065:5 --segments 6 --starts 8");
  INFO(tree);
  CHECK(tree.find("2 branches.") != std::string::npos);
  CHECK(std::regex_search(tree, std::regex("\nb[0-9]+  1.045 to 1.065, attractor s2 ")));
}

TEST_CASE("mirror images of equal periods, means and largest values are two branches") {
  const Workspace workspace;
  const std::string starts = " --state 1,0.1,0 --state=-1,0.1,0";
  const std::string tree =
      explored(workspace, std::string(SYSTEMS) + "/mirrored.tch", "mirrored --over p=0.8:1.2:5" + starts);
  INFO(tree);
  CHECK(tree.find("2 branches.") != std::string::npos);
  CHECK(tree.find("; b1 in the mirror: y1, y2 change sign\n") != std::string::npos);
}

TEST_CASE("an orbit that other events cut is no other branch") {
  // Beyond the grazing point the orbit without impacts is reached again through the minimum, not the maximum.
  const Workspace workspace;
  workspace.write("sections.tch",
                  "par alpha=2.5, omega=2.0072, zeta=0.05, r=0.8\ninit y2=1\ngrowth = 1 - y1^2 - y2^2\nx' = v\n"
                  "v' = alpha*y2 - 2*zeta*v - x\ny1' = growth*y1 + omega*y2\ny2' = growth*y2 - omega*y1\n"
                  "event wall = 1 - x\nevent maximum = v\nevent minimum = -v\njump impact: v -> -r*v\n"
                  "after any: wall -> impact, maximum -> identity, minimum -> identity\n");
  const std::string tree = explored(workspace, "", "sections --over alpha=2.5:3.5:11 --doublings 1 --starts 0");
  INFO(tree);
  CHECK(tree.find("GR 4 at 3.035495345 -> b1") != std::string::npos);
  CHECK(tree.find("4 branches.") != std::string::npos);
}

TEST_CASE("orbits with a segment of no time are one, wherever it lies") {
  // Where y passes zero, top and bottom can both end a segment. UZ labels lie on every branch: no orbit is on two.
  const Workspace workspace;
  workspace.write("forced.tch",
                  "par p=1, w=1\ninit x=1, y=0.1, z2=1\nx' = y\ny' = x - x^3 - 0.3*y + p*z1\n"
                  "z1' = z1*(1 - z1^2 - z2^2) + w*z2\nz2' = z2*(1 - z1^2 - z2^2) - w*z1\n"
                  "event top = y\nevent bottom = -y\nafter any: top -> identity, bottom -> identity\n");
  const Outcome outcome = workspace.tchat({"explore", "forced", "--over", "p=0.1:0.5:11", "-o", "d", "-j", "2", "-q",
                                           "--doublings", "0", "--branches", "12", "UZR={p:[0.3532,0.4108]}"});
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("d.txt");
  INFO(tree);
  CHECK(std::stoi(tree.substr(tree.rfind('\n', tree.find(" branches. Coverage")) + 1)) <= 8);
}

TEST_CASE("what comes to rest is no periodic orbit, however small it turns") {
  const Workspace workspace;
  workspace.write("well.tch",
                  "par a=1\ninit x=0.1\nx' = v\nv' = a*x - x^3 - 0.2*v\nevent top = v\nevent wall = 3 - x\n"
                  "jump hit: v -> -0.8*v\nafter any: top -> identity, wall -> hit\n");
  const std::string tree = explored(workspace, "", "well --over a=0.5:2:11 --starts 4");
  CHECK(tree.find("2 branches. Coverage: 66 of 66 equilibria of the sweep") != std::string::npos);
  // At the bottom but for rounding: f = 0 to the last digit, and integration has nothing to resolve.
  const Outcome rest = workspace.tchat("simulate well --state 0.7071067797565609,3.2266068485765065e-10 PAR(a)=0.5");
  INFO(rest.text());
  CHECK(rest.status == 0);
  CHECK(rest.out.find("converges to the equilibrium x = (0.707107, ") != std::string::npos);
}

TEST_CASE("a motion that escapes does not widen the box of further starts") {
  const Workspace workspace;
  workspace.write("well.tch", "par p=1\ninit x=0.5\nx' = -p*x + x^3\ny' = -y\n");
  const Outcome outcome =
      workspace.tchat("explore well --over p=1:2:5 --state 0.5,0.1 --state 1.6,0.1 --starts 5 -o d -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string starts = workspace.read("d/starts.sweep");
  std::size_t count = 0;
  for (std::size_t at = starts.find(": x = ("); at != std::string::npos; at = starts.find(": x = (", at + 1), ++count)
    CHECK(std::stod(starts.substr(at + 7)) <= 1.6);
  CHECK(count == 5);
}

TEST_CASE("budgets leave switches, which are counted") {
  const Workspace workspace;
  REQUIRE(workspace.tchat("explore linosc --over alpha=2.5:3.5:51 PAR(omega)=2.0072 -o osc -q --segments 1").status ==
          0);
  const std::string tree = workspace.read("osc.txt");
  INFO(tree);
  CHECK(tree.find("PD 3 at 3.036193566: left by --segments 1") != std::string::npos);
  CHECK(tree.find("1 by --segments 1") != std::string::npos);
}

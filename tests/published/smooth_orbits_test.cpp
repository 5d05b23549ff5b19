// Orbits without a section against closed forms. In the plane r' = r (mu + a r^2 - r^4), angle' = 1 + r^2 / 2: circles
// of mu = r^4 - a r^2 with T = 2 pi / (1 + r^2 / 2), multipliers 1 and exp(T (2 a r^2 - 4 r^4)), folds where r^2 = a /
// 2, mu = -a^2 / 4. Beside it a linear oscillator y that the circle drives: its multipliers are exp((d + e r^2 + i w)
// T), or, in axes that turn by half the angle, -exp(d_k T).
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

/// `beside`: the equations of y1, y2; the exponent is d + e r^2.
std::string plugin(const std::string& beside) {
  return R"(#include <tchat/problem.hpp>
struct Circle {
  static constexpr int dimension = 4, parameters = 4, fields = 1;
  static constexpr const char* state_names[] = {"x1", "x2", "y1", "y2"};
  static constexpr const char* parameter_names[] = {"mu", "a", "d", "e"};
  static constexpr double initial_parameters[] = {0.6336, 1.0, -2.0, 1.0};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T r2 = x[0] * x[0] + x[1] * x[1];
    const T growth = par[0] + par[1] * r2 - r2 * r2;
    const T turn = 1.0 + 0.5 * r2;
    const T r = sqrt(r2);
    f[0] = growth * x[0] - turn * x[1];
    f[1] = growth * x[1] + turn * x[0];
    const T d = par[2] + par[3] * r2;
    )" + beside +
         R"(
  }
};
TCHAT_PROBLEM(Circle)
)";
}

const char* const torus_beside = "f[2] = d * x[2] - 0.7 * x[3] + 0.0 * r; f[3] = d * x[3] + 0.7 * x[2];";
/// Exponents d and -3 in the turning axes.
const char* const doubling_beside =
    "const T mean = 0.5 * (d - 3.0), half = 0.5 * (d + 3.0), c = x[0] / r, s = x[1] / r;\n"
    "f[2] = mean * x[2] + half * (c * x[2] + s * x[3]) - 0.5 * turn * x[3];\n"
    "f[3] = mean * x[3] + half * (s * x[2] - c * x[3]) + 0.5 * turn * x[2];";

const std::string constants =
    "NDIM = 4, IPS = 180, ICP = [1]\nGCNOSEG = 1, GCFIND = [1], GCHIND = [0], GCGIND = [0]\nNTST = 30, NCOL = 4\n"
    "EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9\n";

/// One turn of the circle r = 1.2 at mu = 0.6336.
std::string circle() {
  std::string text;
  for (int k = 0; k <= 100; ++k) {
    const double angle = 2 * pi * k / 100;
    text += fmt::format("{:.17g} {:.17g} {:.17g} 0 0\n", angle / 1.72, 1.2 * std::cos(angle), 1.2 * std::sin(angle));
  }
  return text;
}

void prepare(const Workspace& workspace, const char* beside) {
  workspace.write("circle.cpp", plugin(beside));
  workspace.write("gc.circle", constants);
  workspace.write("circle.dat", circle());
}

void run(const Workspace& workspace, std::vector<std::string> words) {
  words.insert(words.begin(), {"run", "circle", "-q"});
  const Outcome outcome = workspace.tchat(words);
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
}

/// Of the first node; the orbit is a circle.
double radius2(const SolutionEntry& u) {
  return u.states.front()[0] * u.states.front()[0] + u.states.front()[1] * u.states.front()[1];
}

/// On the circle of the closed form, to what 30 intervals leave (order 8).
void check_circle(const SolutionEntry& u, double tolerance) {
  const double r2 = radius2(u);
  check_near(u.parameter(1), r2 * r2 - u.parameter(2) * r2, tolerance);
  check_near(u.parameter(61), 2 * pi / (1.0 + 0.5 * r2), tolerance);
}

std::vector<SolutionEntry> of_kind(const Workspace& workspace, const std::string& name, int type) {
  std::vector<SolutionEntry> found;
  for (const SolutionEntry& u : workspace.solutions(name))
    if (std::abs(u.type) % 10 == type) found.push_back(u);
  return found;
}

}  // namespace

TEST_CASE("a smooth orbit without a section: period, trivial multiplier and the others, fold, its curve") {
  const Workspace workspace;
  prepare(workspace, torus_beside);
  run(workspace, {"ICP=[mu]", "DS=-0.05", "DSMAX=0.2", "NMX=60", "NPR=5", "RL0=-1", "RL1=0.7", "-o", "branch"});
  const std::vector<SolutionEntry> labels = workspace.solutions("branch");
  REQUIRE(labels.size() > 6);
  const auto diagnostics = read_diagnostics(workspace.read("d.branch"));
  for (const SolutionEntry& u : labels) {
    if (radius2(u) < 0.05) continue;
    check_circle(u, 1e-8);
    const double r2 = radius2(u);
    const double T = u.parameter(61);
    const DiagnosticPoint& point = with_label(diagnostics, u.label);
    REQUIRE(point.multipliers.size() == 4);
    check_near(std::abs(point.multipliers.front() - 1.0), 0.0, 1e-7);  // the trivial one comes first
    CHECK(distance_to(point.multipliers, std::exp(T * (2 * u.parameter(2) * r2 - 4 * r2 * r2))) < 1e-7);
    CHECK(distance_to(point.multipliers, std::exp(std::complex<double>(u.parameter(3) + r2, 0.7) * T)) < 1e-7);
  }
  const auto folds = of_kind(workspace, "branch", 5);
  REQUIRE(folds.size() == 1);
  check_near(folds.front().parameter(1), -0.25, 1e-9);
  check_near(radius2(folds.front()), 0.5, 1e-6);

  run(workspace, {"-s", "branch", "IRS=LP1", "ISW=2", "ICP=[a, mu]", "DS=0.05", "DSMAX=0.2", "NMX=30", "NPR=4",
                  "RL0=0.3", "RL1=2", "-o", "folds"});
  const std::vector<SolutionEntry> curve = workspace.solutions("folds");
  REQUIRE(curve.size() > 3);
  for (const SolutionEntry& u : curve) {
    check_near(u.parameter(1), -0.25 * u.parameter(2) * u.parameter(2), 1e-8);
    check_near(u.parameter(61), 2 * pi / (1.0 + 0.25 * u.parameter(2)), 1e-7);
  }
}

TEST_CASE("a torus bifurcation without a section, and its curve") {
  const Workspace workspace;
  prepare(workspace, torus_beside);
  run(workspace, {"ICP=[d]", "DS=0.05", "DSMAX=0.2", "NMX=40", "RL0=-3", "RL1=-1", "-o", "branch"});
  const auto tori = of_kind(workspace, "branch", 8);
  REQUIRE(tori.size() == 1);
  check_near(tori.front().parameter(3), -1.44, 1e-9);
  run(workspace, {"-s", "branch", "IRS=TR1", "ISW=2", "ICP=[mu, d]", "DS=0.05", "DSMAX=0.2", "NMX=30", "NPR=4",
                  "RL0=0.1", "RL1=1.5", "-o", "curve"});
  const std::vector<SolutionEntry> curve = workspace.solutions("curve");
  REQUIRE(curve.size() > 3);
  for (const SolutionEntry& u : curve) {
    check_circle(u, 1e-8);
    check_near(u.parameter(3), -radius2(u), 1e-8);
  }
}

TEST_CASE("a period doubling without a section: its curve, and the doubled orbit as one segment") {
  const Workspace workspace;
  prepare(workspace, doubling_beside);
  run(workspace, {"ICP=[d]", "DS=0.05", "DSMAX=0.2", "NMX=40", "RL0=-3", "RL1=-1", "-o", "branch"});
  const auto doublings = of_kind(workspace, "branch", 7);
  REQUIRE(doublings.size() == 1);
  check_near(doublings.front().parameter(3), -1.44, 1e-9);
  run(workspace, {"-s", "branch", "IRS=PD1", "ISW=2", "ICP=[mu, d]", "DS=0.05", "DSMAX=0.2", "NMX=30", "NPR=4",
                  "RL0=0.1", "RL1=1.5", "-o", "curve"});
  for (const SolutionEntry& u : workspace.solutions("curve")) check_near(u.parameter(3), -radius2(u), 1e-8);
  // The deviations are linear: the doubled orbits are all at the same d, of any size, twice the period.
  run(workspace,
      {"-s", "branch", "IRS=PD1", "ISW=-1", "ICP=[d]", "DS=0.1", "DSMAX=0.2", "NMX=6", "NPR=1", "-o", "twice"});
  const std::vector<SolutionEntry> twice = workspace.solutions("twice");
  REQUIRE(twice.size() >= 4);
  for (const SolutionEntry& u : twice) {
    check_near(u.parameter(3), -1.44, 1e-8);
    check_near(u.parameter(61), 4 * pi / 1.72, 1e-8);
    CHECK(std::hypot(u.states.front()[2], u.states.front()[3]) > 0.01);
  }
}

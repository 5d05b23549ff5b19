// Normal forms at branch points, and at labels of equilibria: against closed forms, against the branch that is born,
// and as data. No normal form where a segment is tangent to its surface.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/printed_form.hpp"

using namespace test_support;

namespace {

/// Once in a unit of time X = x - p - p^2 -> (1 + p)^2 X + b X^2 + c X^3 + e X z, z -> z / 2 + k X^2. At p = 0 the
/// centre manifold is z = 2 k X^2: for b = 0 the cubic coefficient is c + 2 k e. Multipliers of X = 0: (1 + p)^2 and
/// 1/2.
constexpr const char* forking_map = R"(par p=-0.1, b=0, c=-0.3, e=0.2, k=0.5
init x=-0.09
x' = 0
z' = 0
phi' = 1
event half = 0.5 - phi
event turn = 1 - phi
L = log(1+x)
X = L - p - p^2
jump stretch: x -> exp(x) - 1
jump back: x -> p + p^2 + (1+p)^2*X + b*X^2 + c*X^3 + e*X*z, z -> 0.5*z + k*X^2, phi -> phi - 1
after start: half -> stretch
after half: turn -> back
after turn: half -> stretch
)";

/// The flow with the same equations, in 3 X for X.
constexpr const char* forking_flow = R"(par p=-0.1, b=0, c=-0.3, e=0.2, k=0.5
init x=-0.27
X = x/3 - p - p^2
x' = 3*(2*p*X + b*X^2 + c*X^3 + e*X*z)
z' = -z + k*X^2
event far = 10 - x
after any: far -> identity
)";

const std::string steps = " DS=0.02 DSMAX=0.05 RL0=-0.2 RL1=0.1 NMX=40";

/// Are all points of d.NAME but the first stable (1), or unstable (-1)? 0: some are, some are not.
int stability_behind_start(const Workspace& workspace, const std::string& name) {
  const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d." + name));
  REQUIRE(points.size() > 3);
  int sum = 0;
  for (std::size_t k = 1; k < points.size(); ++k) sum += points[k].point < 0 ? 1 : -1;
  const int count = static_cast<int>(points.size()) - 1;
  return sum == count ? 1 : sum == -count ? -1 : 0;
}

void check(const PrintedForm& form, const std::string& name, double value, const std::string& verdict) {
  INFO(form.name << " = " << form.value << " +- " << form.uncertainty << form.verdict);
  CHECK(form.name == name);
  CHECK(form.value == Approx(value).epsilon(1e-9));
  CHECK(std::abs(form.value - value) <= form.uncertainty + 1e-10);
  CHECK(form.uncertainty < 1e-9);
  CHECK(form.verdict.find(verdict) == 0);
}

/// b of "+- b dp, b = 2 +- 3e-13".
double rate(const PrintedForm& form) {
  const std::string before = "dp, b = ";
  const std::size_t at = form.verdict.find(before);
  REQUIRE(at != std::string::npos);
  return std::stod(form.verdict.substr(at + before.size()));
}

Eigen::VectorXd start(const SolutionEntry& entry) {
  return Eigen::Map<const Eigen::VectorXd>(entry.states.front().data(), entry.dimension);
}

}  // namespace

TEST_CASE("branch point of periodic orbits, pitchfork: in closed form, and what is born has the stability told") {
  const Workspace workspace;
  simulate(workspace, "fork", forking_map, "--state -0.09,0,0 --free p");
  for (const double c : {-0.3, 0.4}) {
    workspace.succeed("run fork -q -c fork -d fork -o fork PAR(c)=" + std::to_string(c) + steps);
    const bool supercritical = c + 0.2 < 0.0;
    check(form_at(workspace, "fork", "BP"), "c", c + 0.2,
          supercritical ? ", supercritical pitchfork: the branch that turns here is stable"
                        : ", subcritical pitchfork: the branch that turns here is unstable");
    workspace.succeed("run fork -q -c r.fork -s fork -o born IRS=BP1 ISW=-1 IID=3 NMX=12 RL1=0.5 DS=0.01 DSMAX=0.02");
    CHECK(stability_behind_start(workspace, "born") == (supercritical ? 1 : -1));
  }
}

TEST_CASE("branch point of periodic orbits, transcritical: in closed form, and the branches exchange their stability") {
  const Workspace workspace;
  simulate(workspace, "fork", forking_map, "--state -0.09,0,0 --free p");
  for (const char* const b : {"0.4", "-0.0001"}) {
    workspace.succeed(std::string("run fork -q -c fork -d fork -o fork PAR(b)=") + b + steps);
    const PrintedForm form = form_at(workspace, "fork", "BP");
    check(form, "a", std::stod(b), ", transcritical: stability passes from one branch to the other");
    CHECK(rate(form) == Approx(2.0).epsilon(1e-9));
  }
  workspace.succeed("run fork -q -c fork -d fork -o fork PAR(b)=0.4" + steps);
  for (const char* const ds : {"0.01", "-0.01"}) {
    workspace.succeed(std::string("run fork -q -c r.fork -s fork -o other IRS=BP1 ISW=-1 IID=3 NMX=8 DSMAX=0.02 DS=") +
                      ds);
    const auto points = workspace.solutions("other");
    REQUIRE(!points.empty());
    CHECK(stability_behind_start(workspace, "other") == (points.back().parameter(1) > 0.0 ? 1 : -1));
  }
}

TEST_CASE("branch point of cycles without a section, in closed form: the parameter is in the field") {
  // On the cycle of radius sqrt(1 + p) and period T = 2 / (1 + c p) the map of z is z -> e^(p T) z - T z^2 at p = 0.
  const Workspace workspace;
  simulate(workspace, "cycle", R"(par p=-0.1, c=0.5, k=0.3
init x=0.9
s = 1 + p - x^2 - y^2
w = 3.14159265358979324*(1 + c*p)
x' = s*x - w*y
y' = s*y + w*x
z' = p*z - z^2 + k*z*s
)",
           "--free p");
  workspace.succeed("run cycle -q -c cycle -d cycle -o cycle" + steps);
  const PrintedForm form = form_at(workspace, "cycle", "BP");
  check(form, "a", -2.0, ", transcritical: stability passes from one branch to the other");
  CHECK(rate(form) == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("coefficients of normal forms in the tables of labels and of points") {
  const Workspace workspace;
  simulate(workspace, "fork", forking_map, "--state -0.09,0,0 --free p");
  workspace.succeed("run fork -q -c fork -d fork -o fork PAR(c)=0.4" + steps);
  const PrintedForm form = form_at(workspace, "fork", "BP");
  const std::string value = fmt::format("{:.10g}", form.value), uncertainty = fmt::format("{:.1g}", form.uncertainty);
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string labels = workspace.succeed("labels fork").out;
  CHECK(has(labels, "normal form c = " + value + " +- " + uncertainty + ", subcritical pitchfork\n"));
  const std::string json = workspace.succeed("labels fork --json").out;
  CHECK(has(json, "\"normal_form\": \"c\", \"coefficient\": " + value));
  CHECK(has(json, "\"verdict\": \"subcritical pitchfork\""));
  CHECK(has(json, "\"verdict\": null"));
  const std::string column = workspace.succeed("table fork --column coefficient --column 2*uncertainty").out;
  CHECK(has(column, "section,point,coefficient,2*uncertainty\n1,1,,\n"));
  CHECK(has(column, "," + value + ","));
}

TEST_CASE("where another multiplier is outside the unit circle, no branch at a branch point is called stable") {
  const Workspace workspace;
  std::string formulas = forking_map;
  formulas.replace(formulas.find("phi' = 1\n"), 9, "phi' = 1\nother' = 0.1*other\n");
  simulate(workspace, "fork", formulas, "--state -0.09,0,0,0 --free p");
  workspace.succeed("run fork -q -c fork -d fork -o fork" + steps);
  check(form_at(workspace, "fork", "BP"), "c", -0.1, ", supercritical pitchfork; another multiplier");
}

TEST_CASE("branch points of equilibria in closed form") {
  const Workspace workspace;
  simulate(workspace, "rest", forking_flow, "--state -0.27,0 --free p");
  // |q| = 1 in 3 X: a is divided by 3, c by 9. The centre manifold is z = k X^2.
  workspace.succeed("run rest -q -c rest -d rest -o rest" + steps);
  check(form_at(workspace, "rest", "BP"), "c", -0.2 / 9.0, ", supercritical pitchfork: the branch that turns");
  workspace.succeed("run rest -q -c rest -d rest -o rest PAR(c)=0.3" + steps);
  check(form_at(workspace, "rest", "BP"), "c", 0.4 / 9.0, ", subcritical pitchfork: the branch that turns");
  workspace.succeed("run rest -q -c rest -d rest -o rest PAR(b)=0.6" + steps);
  const PrintedForm form = form_at(workspace, "rest", "BP");
  check(form, "a", 0.2, ", transcritical: stability passes");
  CHECK(rate(form) == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("fold and Hopf bifurcation of equilibria in closed form") {
  const Workspace workspace;
  // z = k X^2 is slaved to X, and does not act on the quadratic coefficient of X' = p - a X^2 in 3 X.
  simulate(workspace, "fold", R"(par p=0.5, a=0.6, e=0.2, k=0.5
init x=2.7
X = x/3
x' = 3*(p - a*X^2 + e*X*z)
z' = -z + k*X^2
event far = 10 - x
after any: far -> identity
)",
           "--free p");
  workspace.succeed("run fold -q -c fold -d fold -o fold DS=-0.02 DSMAX=0.1 RL0=-1 RL1=1 NMX=60");
  check(form_at(workspace, "fold", "LP"), "a", -0.2, "");

  // w' = (s + i omega) w - alpha |w|^2 w in bent coordinates: r' = s r - alpha r^3, l_1 = -2 alpha / omega.
  simulate(workspace, "bent", R"(par s=-0.1, alpha=0.7, k=0.5, omega=1.3
init x=0, y=0
X = x
Y = y - k*x^2
dX = s*X - omega*Y - alpha*X*(X^2 + Y^2)
dY = s*Y + omega*X - alpha*Y*(X^2 + Y^2)
x' = dX
y' = dY + 2*k*x*dX
event far = 10 - x
after any: far -> identity
)",
           "--free s");
  for (const double alpha : {0.7, -0.4}) {
    workspace.succeed("run bent -q -c bent -d bent -o bent DS=0.02 RL1=0.1 NMX=20 PAR(alpha)=" + std::to_string(alpha));
    check(form_at(workspace, "bent", "HB"), "l_1", -2.0 * alpha / 1.3,
          alpha > 0.0 ? ", supercritical: stable orbits where this equilibrium is unstable"
                      : ", subcritical: unstable orbits where this equilibrium is stable");
  }
}

TEST_CASE("no normal form where the end of a segment is tangent to its event surface") {
  // The surface is at an angle of 1e-5 to the flow; jumps leave s = 1 on it.
  const Workspace workspace;
  simulate(workspace, "tangent", R"(par p=-0.1, b=0.4, c=0.3
init x=0.01, s=1
x' = 0
s' = 0
phi' = 1
event turn = s - 1 + 1e-5*(1 - phi)
jump back: x -> -(1+p)*x + b*x^2 + c*x^3, s -> 1, phi -> phi - 1
after any: turn -> back
)",
           "--state 0,1,0 --free p");
  workspace.succeed("run tangent -q -c tangent -d tangent -o tangent DS=0.02 RL1=0.1 NMX=20");
  const std::vector<DiagnosticPoint> points = of_type(read_diagnostics(workspace.read("d.tangent")), "PD");
  REQUIRE(points.size() == 1);
  CHECK(std::isnan(printed_form(points.front().notes).value));
  const auto says = [&](const std::string& words) {
    return std::count_if(points.front().notes.begin(), points.front().notes.end(),
                         [&](const std::string& note) { return note.find(words) != std::string::npos; });
  };
  CHECK(says("no normal form: the end of segment 1 is tangent to its event surface") == 1);
}

TEST_CASE("the pitchfork of orbits between two walls: the square distance of the asymmetric ones is (1 - mu) / c") {
  const Workspace workspace;
  workspace.write("walls.tch", R"(par F=6, omega=2.5, zeta=0.05, r=0.8
init c=1
q' = v
v' = F*c - 2*zeta*v - q
s' = (1 - s^2 - c^2)*s + omega*c
c' = (1 - s^2 - c^2)*c - omega*s
event right = 1 - q
event left = 1 + q
jump impact: v -> -r*v
after any: right -> impact, left -> impact
)");
  workspace.succeed("simulate walls -q --transient-events 200 --dat walls --free F");
  const std::string values = "UZR={F:[4.6934,4.6944,4.6954,4.6964,4.6974,4.6984]}";
  workspace.succeed({"run", "walls", "-q", "-c", "walls", "-d", "walls", "-o", "sides", "NMX=300", "RL0=4.5", "RL1=7",
                     "DS=-0.02", "DSMAX=0.2", values});
  workspace.succeed({"run", "walls", "-q", "-c", "r.sides", "-s", "sides", "-o", "below", "IRS=BP1", "ISW=-1", "NMX=9",
                     "DS=-0.01", "DSMAX=0.05"});
  workspace.succeed({"run", "walls", "-q", "-c", "r.sides", "-s", "below", "-o", "middle", "IRS=EP1", "NMX=60",
                     "DS=-0.01", "DSMAX=0.05", "RL0=4", "RL1=4.72", values});
  const PrintedForm form = form_at(workspace, "sides", "BP"), other = form_at(workspace, "middle", "BP");
  const double at = only(workspace, "sides", "BP").parameter(1);
  const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d.middle"));
  const auto is_user_value = [](const SolutionEntry& e) { return !e.internal.empty() && e.internal.front() == 1.0; };
  std::vector<double> beyond, ratios;
  for (const SolutionEntry& middle : workspace.solutions("middle")) {
    if (!is_user_value(middle)) continue;
    std::vector<Eigen::VectorXd> pair;
    for (const SolutionEntry& side : workspace.solutions("sides"))
      if (is_user_value(side) && std::abs(side.parameter(1) - middle.parameter(1)) < 1e-8) pair.push_back(start(side));
    if (pair.size() != 2) continue;
    double multiplier = INFINITY;
    for (const std::complex<double>& mu : with_label(points, middle.label).multipliers)
      if (std::abs(mu - 1.0) < std::abs(multiplier - 1.0)) multiplier = mu.real();
    beyond.push_back(middle.parameter(1) - at);
    ratios.push_back((1.0 - multiplier) / (0.25 * (pair[0] - pair[1]).squaredNorm()));
  }
  REQUIRE(beyond.size() == 6);
  CHECK(form.name == "c");
  CHECK(form.value == Approx(at_zero(beyond, ratios, 4)).epsilon(1e-5));
  CHECK(form.verdict.find(", supercritical pitchfork") == 0);
  CHECK(other.value == Approx(form.value).epsilon(1e-8));  // of the symmetric orbits
  CHECK(other.verdict == form.verdict);

  for (const char* const intervals : {"3", "5", "10", "20"}) {  // asymmetric meshes that know how well they know c
    workspace.succeed({"run", "walls", "-q", "-c", "walls", "-d", "walls", "-o", "coarse", "NMX=60", "RL0=4.5",
                       "DS=-0.02", "DSMAX=0.2", std::string("NTST=") + intervals});
    const PrintedForm coarse = form_at(workspace, "coarse", "BP");
    INFO(intervals << " intervals: " << coarse.value << " +- " << coarse.uncertainty);
    CHECK(coarse.name == "c");
    CHECK(std::abs(coarse.value - form.value) <= coarse.uncertainty + 1e-9);
    CHECK(coarse.uncertainty < 0.01);
  }
}

// Normal forms at PD, LP and TR labels: against closed forms, against the branch that is born, and against each other
// on different meshes.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bouncing_ball.hpp"
#include "published/printed_form.hpp"

using namespace test_support;

namespace {

/// x -> -(1 + p) x + b x^2 + c x^3 once in a unit of time has f''' / 6 + (f'' / 2)^2 = c + b^2 at p = 0.
constexpr const char* cubic_map = R"(par p=-0.1, b=0.4, c=0.3, a=1
init x=0
x' = 0
phi' = 1
event half = 0.5 - phi
event turn = 1 - phi
jump stretch: x -> exp(a*x) - 1
jump back: x -> -(1+p)*log(1+x)/a + b*(log(1+x)/a)^2 + c*(log(1+x)/a)^3, phi -> phi - 1
after start: half -> stretch
after half: turn -> back
after turn: half -> stretch
)";

/// w' = (s + i omega) w - (alpha - i beta) |w|^2 w for w = X + i Y in bent coordinates: at s = 0 the map of the time T
/// multiplies w by e^(i omega T) (1 - (alpha - i beta) T |w|^2); with |q| = 1 it is w = sqrt(2) z, d = -2 (alpha - i
/// beta) T.
constexpr const char* bent_oscillator = R"(par s=-0.1, alpha=0.7, beta=0.3, k=0.5, omega=1.3
init x=0, y=0
X = x
Y = y - k*x^2
square = X^2 + Y^2
dX = s*X - omega*Y - (alpha*X - beta*Y)*square
dY = s*Y + omega*X - (alpha*Y + beta*X)*square
x' = dX
y' = dY + 2*k*x*dX
phi' = 1
event turn = 1 - phi
jump back: phi -> phi - 1
after any: turn -> back
)";

Eigen::VectorXd start(const SolutionEntry& entry, int segment) {
  const auto n = static_cast<std::size_t>(entry.dimension);
  return Eigen::Map<const Eigen::VectorXd>(entry.states.front().data() + static_cast<std::size_t>(segment) * n,
                                           static_cast<Eigen::Index>(n));
}

bool is_user_value(const SolutionEntry& entry) { return !entry.internal.empty() && entry.internal.front() == 1.0; }

}  // namespace

TEST_CASE("normal form of a period doubling, in closed form: two segments and jumps that bend") {
  const Workspace workspace;
  simulate(workspace, "map", cubic_map, "--state 0,0 --free p");
  for (const auto& [b, c] : {std::pair{0.4, 0.3}, {0.4, -0.3}, {1.5, -2.0}}) {
    const std::string values = " PAR(b)=" + std::to_string(b) + " PAR(c)=" + std::to_string(c);
    workspace.succeed("run map -q -c map -d map -o map DS=0.02 RL1=0.1 NMX=20" + values);
    const PrintedForm form = form_at(workspace, "map", "PD");
    CHECK(form.name == "c");
    CHECK(form.value == Approx(c + b * b).epsilon(1e-9));
    CHECK(std::abs(form.value - (c + b * b)) <= form.uncertainty + 1e-10);
    CHECK((form.verdict.find("supercritical: stable") != std::string::npos) == (c + b * b > 0.0));
    CHECK((form.verdict.find("subcritical: unstable") != std::string::npos) == (c + b * b < 0.0));
  }
}

TEST_CASE("a multiplier that changes fast along the branch, as it does close to grazing") {
  const Workspace workspace;
  std::string formulas = cubic_map;
  formulas.replace(formulas.find("p=-0.1"), 6, "p=-5e-6");
  formulas.replace(formulas.find("(1+p)"), 5, "(1+2e4*p)");
  simulate(workspace, "fast", formulas, "--state 0,0 --free p");
  workspace.succeed("run fast -q -c fast -d fast -o fast DS=1e-6 DSMAX=1e-6 RL1=5e-6 NMX=20");
  const PrintedForm form = form_at(workspace, "fast", "PD");
  CHECK(form.value == Approx(0.46).epsilon(1e-9));
  CHECK(std::abs(form.value - 0.46) <= form.uncertainty + 1e-10);
  CHECK(form.uncertainty < 1e-9);
}

TEST_CASE("strong damping and growth along the orbit leave the normal form as it is") {
  // States that follow x, and do not act back: one is damped by e^-300, one grows by e^30 and is reset.
  const Workspace workspace;
  std::string formulas = cubic_map;
  formulas.replace(formulas.find("phi' = 1\n"), 9, "phi' = 1\ndamped' = x - 300*damped\ngrowing' = x + 30*growing\n");
  formulas.replace(formulas.find("phi -> phi - 1"), 14, "phi -> phi - 1, growing -> growing*exp(-35)");
  simulate(workspace, "map", formulas, "--state 0,0,0,0 --free p");
  workspace.succeed("run map -q -c map -d map -o map DS=0.02 RL1=0.1 NMX=20");
  const PrintedForm form = form_at(workspace, "map", "PD");
  CHECK(form.uncertainty < 1e-9);
  // With 1 for x, q has y = -1 / 300 and z = -(1 - e^-30) e^-5 / (30 (1 + e^-5)); c goes with its square.
  const double y = 1.0 / 300.0, z = (1.0 - std::exp(-30.0)) * std::exp(-5.0) / (30.0 * (1.0 + std::exp(-5.0)));
  CHECK(form.value == Approx(0.46 / (1.0 + y * y + z * z)).epsilon(1e-9));
}

TEST_CASE("where another multiplier is outside the unit circle, nothing is called stable") {
  const Workspace workspace;
  std::string formulas = cubic_map;
  formulas.replace(formulas.find("phi' = 1\n"), 9, "phi' = 1\nother' = 0.02*other\n");  // e^0.02, near 1
  simulate(workspace, "map", formulas, "--state 0,0,0 --free p");
  workspace.succeed("run map -q -c map -d map -o map DS=0.02 RL1=0.1 NMX=20");
  const PrintedForm form = form_at(workspace, "map", "PD");
  CHECK(form.value == Approx(0.46).epsilon(1e-9));
  CHECK(form.verdict.find("supercritical; another multiplier") != std::string::npos);
  CHECK(form.verdict.find("stable doubled orbits") == std::string::npos);
}

TEST_CASE("normal form of a torus bifurcation, in closed form") {
  const Workspace workspace;
  simulate(workspace, "bent", bent_oscillator, "--state 0,0,0 --free s");
  workspace.succeed("run bent -q -c bent -d bent -o bent DS=0.02 RL1=0.1 NMX=20");
  const PrintedForm form = form_at(workspace, "bent", "TR");
  CHECK(form.name == "Re d");
  CHECK(form.value == Approx(-1.4).epsilon(1e-9));
  CHECK(form.verdict.find("supercritical: stable tori") != std::string::npos);
  workspace.succeed("run bent -q -c bent -d bent -o bent DS=0.02 RL1=0.1 NMX=20 PAR(alpha)=-0.2");
  const PrintedForm other = form_at(workspace, "bent", "TR");
  CHECK(other.value == Approx(0.4).epsilon(1e-9));
  CHECK(other.verdict.find("subcritical: unstable tori") != std::string::npos);

  SECTION("at a strong resonance there is none") {
    workspace.succeed({"run", "bent", "-q", "-c", "bent", "-d", "bent", "-o", "third", "DS=0.02", "RL1=0.1", "NMX=20",
                       "PAR(omega)=2.0943951023931953"});
    CHECK(workspace.read("d.third").find("strong resonance") != std::string::npos);
  }
}

TEST_CASE("normal forms of the bouncing ball against its branches") {
  const Workspace workspace;
  simulate(workspace, "ball", bouncing_ball, "--free Gamma");

  SECTION("the doubled orbits: their square distance from the simple one is (-1 - mu) / c") {
    const std::string values = "UZR={Gamma:[1.5278,1.5288,1.5298,1.5308,1.5318,1.5328]}";
    workspace.succeed(
        {"run", "ball", "-q", "-c", "ball", "-d", "ball", "-o", "one", "RL1=1.6", "DSMAX=0.05", "NMX=80", values});
    workspace.succeed({"run", "ball", "-q", "-c", "r.one", "-s", "one", "IRS=PD1", "ISW=-1", "-o", "two", "NMX=200",
                       "DS=0.005", "DSMAX=0.03", "RL1=1.54", values});
    const PrintedForm form = form_at(workspace, "one", "PD");
    const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d.one"));
    const double doubling = only(workspace, "one", "PD").parameter(1);
    std::vector<double> beyond, ratios;
    for (const SolutionEntry& doubled : workspace.solutions("two"))
      for (const SolutionEntry& simple : workspace.solutions("one")) {
        if (!is_user_value(doubled) || !is_user_value(simple)) continue;
        if (std::abs(doubled.parameter(1) - simple.parameter(1)) > 1e-8) continue;
        double multiplier = 0.0;
        for (const std::complex<double>& mu : with_label(points, simple.label).multipliers)
          multiplier = std::min(multiplier, mu.real());
        beyond.push_back(simple.parameter(1) - doubling);
        ratios.push_back((-1.0 - multiplier) / (0.25 * (start(doubled, 0) - start(doubled, 1)).squaredNorm()));
      }
    REQUIRE(beyond.size() == 6);
    // The fit of degree 4 leaves (6e-3)^5, the multipliers' ten digits 1e-7.
    CHECK(form.value == Approx(at_zero(beyond, ratios, 4)).epsilon(1e-6));
  }
  SECTION("the fold: multipliers go with the distance from it as 1 + 2 a eta") {
    workspace.succeed({"run", "ball", "-q", "-c", "ball", "-d", "ball", "-o", "fold", "RL0=1", "DS=-0.01", "DSMAX=0.03",
                       "NMX=60", "UZR={Gamma:[1.0474,1.0476,1.048,1.0485,1.049,1.0495]}"});
    const PrintedForm form = form_at(workspace, "fold", "LP");
    const SolutionEntry fold = only(workspace, "fold", "LP");
    const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d.fold"));
    std::vector<double> distances, slopes;
    Eigen::VectorXd q;
    for (const SolutionEntry& entry : workspace.solutions("fold")) {
      if (!is_user_value(entry)) continue;
      const Eigen::VectorXd difference = start(entry, 0) - start(fold, 0);
      if (q.size() == 0) {  // its entry of largest modulus is positive
        Eigen::Index largest = 0;
        difference.cwiseAbs().maxCoeff(&largest);
        q = difference.normalized() * (difference(largest) > 0.0 ? 1.0 : -1.0);
      }
      double multiplier = INFINITY;
      for (const std::complex<double>& mu : with_label(points, entry.label).multipliers)
        if (std::abs(mu - 1.0) < std::abs(multiplier - 1.0)) multiplier = mu.real();
      distances.push_back(q.dot(difference));
      slopes.push_back((multiplier - 1.0) / (2.0 * q.dot(difference)));
    }
    REQUIRE(distances.size() == 12);
    CHECK(form.name == "a");
    CHECK(form.value == Approx(at_zero(distances, slopes, 7)).epsilon(1e-4));
  }
  SECTION("a coarse mesh knows how well it knows") {
    workspace.succeed("run ball -q -c ball -d ball -o fine RL1=1.6 DSMAX=0.05 NMX=80 NTST=100");
    const double exact = form_at(workspace, "fine", "PD").value;
    for (const char* const intervals : {"4", "7", "10", "20", "40"}) {
      workspace.succeed(std::string("run ball -q -c ball -d ball -o coarse RL1=1.6 DSMAX=0.05 NMX=80 NTST=") +
                        intervals);
      const PrintedForm form = form_at(workspace, "coarse", "PD");
      INFO(intervals << " intervals: " << form.value << " +- " << form.uncertainty);
      CHECK(std::abs(form.value - exact) <= 1.1 * form.uncertainty + 1e-10);
      CHECK(form.uncertainty < 0.1);
    }
  }
}

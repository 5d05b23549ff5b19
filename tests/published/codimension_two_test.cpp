// Points of codimension two on curves of orbits, and the curves that meet there, of maps in closed form: the map is the
// jump of a clock.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
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

/// The equilibria of map.tch over p.
void follow_rest(const Workspace& workspace) {
  workspace.succeed("simulate map --free p --dat rest -o rest -q");
  workspace.succeed("run map -q -d rest -c rest -o rest DS=0.01 DSMAX=0.05 RL1=1 NMX=60");
}

/// The cycles that are born at the first HB of them.
void follow_cycle(const Workspace& workspace) {
  workspace.succeed("run map -q -c r.rest -s rest -o cycle IRS=HB1 IPS=180 ISW=-1 DS=0.01 DSMAX=0.05 NMX=60 RL1=2");
}

/// A curve in p and q from a label of NAME, in the direction `ds` of q as long as |q| < 0.5.
void follow(const Workspace& workspace, const std::string& name, const std::string& from, const std::string& label,
            const std::string& ds, const std::string& words = "") {
  workspace.succeed("run map -q -c r." + from + " -s " + from + " -o " + name + " ISW=2 ICP=[q,p] IRS=" + label +
                    " DS=" + ds + " DSMAX=0.02 NMX=100 NPR=1 RL0=-0.5 RL1=0.5 " + words);
}

/// The curve in p and q that begins at a label of codimension two of FROM.
void begin(const Workspace& workspace, const std::string& name, const std::string& from, const std::string& label,
           const std::string& ds, const std::string& words = "") {
  workspace.succeed("run map -q -c r." + from + " -s " + from + " -o " + name + " ISW=-1 IRS=" + label + " DS=" + ds +
                    " DSMAX=0.02 NMX=100 NPR=1 RL0=-0.5 RL1=0.5 " + words);
}

/// The label of that type is at (p, q).
void check_place(const Workspace& workspace, const std::string& name, const std::string& type, double p, double q) {
  INFO(name << " " << type);
  const SolutionEntry label = only(workspace, name, type);
  CHECK(std::abs(label.parameter(1) - p) < accuracy);
  CHECK(std::abs(label.parameter(2) - q) < accuracy);
}

/// All points of the curve are at (p(q), q).
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
  follow(workspace, "tori", "tori", "EP1", "-0.02", "CURVE= RL1=0.6");
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
  const auto folds = [](double q) { return -0.25 * q * q; };
  check_curve(workspace, "folds", folds);
  check_place(workspace, "folds", "GPD", 0.0, 0.0);
  CHECK(workspace.solutions("folds").back().type == -51);  // beyond it the curve comes back
  CHECK(workspace.tchat("run map -c r.doublings -s doublings -o born IRS=GPD1 ISW=-1 DS=-0.01 NMX=2").out.find("DS ") ==
        std::string::npos);  // whatever its sign, it leads away
  begin(workspace, "born", "doublings", "GPD1", "0.01");
  check_curve(workspace, "born", folds);
  CHECK(workspace.solutions("born").back().parameter(2) < -0.4);
}

namespace {

/// Folds of doubled orbits, followed to where their halves meet at p = q = 0, with several steps.
void check_ends(const Workspace& workspace, const std::string& limit) {
  workspace.succeed("run map -q -c r.up -s up -o doubled IRS=PD1 ISW=-1 DS=0.01 DSMAX=0.02 NMX=80 " + limit);
  for (const char* const ds : {"0.02", "0.03", "0.015"}) {
    INFO("DS = " << ds);
    workspace.succeed(
        std::string("run map -q -c r.doubled -s doubled -o folds ISW=2 ICP=[q,p] IRS=LP1 NMX=200 NPR=0 ") +
        "RL0=-0.5 RL1=0.5 DSMAX=0.02 DS=" + ds);
    check_place(workspace, "folds", "GPD", 0.0, 0.0);
    CHECK(workspace.tchat("verify q.folds").status == 0);  // its states are those of the same parameters
  }
}

}  // namespace

TEST_CASE("folds of doubled orbits end where an orbit moves with the parameters") {
  const Workspace workspace;
  simulate(workspace, "par p=-0.3, q=-0.3\nc = 1 + 2*q + p^2\ninit z=0.49\nx = z - c\nz' = 0\n",
           "z -> c - (1+p)*x + q*x^3 + x^5");
  check_ends(workspace, "RL0=-0.5");
}

TEST_CASE("folds of doubled orbits end where a flow has no section") {
  // Around the unit circle a band makes half a turn: a' = (p + q a^2 + a^4) a along one of its axes, b' = -b.
  const Workspace workspace;
  workspace.write("map.tch",
                  "par p=-0.3, q=-0.3\ninit x=1\nr = x^2 + y^2\na2 = (u^2 + v^2 + x*(u^2 - v^2) + 2*y*u*v)/2\n"
                  "A = p + q*a2 + a2^2\nx' = x*(1 - r) - y\ny' = y*(1 - r) + x\n"
                  "u' = (A - 1)/2*u + (A + 1)/2*(x*u + y*v) - v/2\nv' = (A - 1)/2*v + (A + 1)/2*(y*u - x*v) + u/2\n");
  workspace.succeed("simulate map --free p -o map --dat map -q");
  workspace.succeed("run map -d map -c map -o up DS=0.01 DSMAX=0.02 NMX=60 RL1=0.1 -q");
  check_ends(workspace, "RL1=0.5");
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

// Coefficients.

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
  // y = 1.2 x^2 + ... on the centre manifold: x + p + q x - (0.7 + 0.4 * 1.2) x^3.
  const Workspace workspace;
  simulate(workspace, "par p=-0.1, q=0.5\ninit x=-0.6, y=0.5\nx' = 0\ny' = 0\n",
           "x -> x + p + q*x - 0.7*x^3 - 0.4*x*y, y -> y/2 + 0.6*x^2");
  workspace.succeed("run map -d map -c map -o fold DS=0.01 DSMAX=0.02 NMX=200 RL1=0.5 STOP=[LP1] -q");
  follow(workspace, "folds", "fold", "LP1", "-0.02");
  check_place(workspace, "folds", "CP", 0.0, 0.0);
  CHECK(printed(workspace, "folds", "CP", "c") == Approx(-1.18).margin(coefficient_accuracy));
}

TEST_CASE("coefficients of the 1:1 resonance, from which curves of folds and of torus bifurcations are followed") {
  // The derivative has the determinant 1 + q - x where y = 0: 1 at q = x, p = -0.7 x^2.
  const Workspace workspace;
  simulate(workspace, "par p=-0.2, q=-0.4\ninit x=-0.5, y=0\nx' = 0\ny' = 0\n",
           "x -> x + y, y -> y + p + (2*q)*y + 0.7*x^2 + 0.4*x*y + 0.2*y^2");
  follow(workspace, "folds", "up", "LP1", "0.02");
  check_place(workspace, "folds", "R1", 0.0, 0.0);
  check_curve(workspace, "folds", folds);
  CHECK(printed(workspace, "folds", "R1", "a") == Approx(0.7).margin(coefficient_accuracy));
  CHECK(printed(workspace, "folds", "R1", "b") == Approx(0.4).margin(coefficient_accuracy));
  follow(workspace, "tori", "folds", "R11", "-0.02", "CURVE=TR");
  check_curve(workspace, "tori", [](double q) { return -0.7 * 4.0 * q * q; });
}

TEST_CASE("coefficients of the 1:2 resonance") {
  // (x, y) -> (-x + y, -(1 + p) y + q x + c x^3 + d x^2 y + e x^2): c + e^2 / 2 and d + e^2.
  const Workspace workspace;
  simulate(workspace, "par q=-0.05, p=-0.3\ninit x=0, y=0\nx' = 0\ny' = 0\n",
           "x -> -x + y, y -> -(1+p)*y + q*x + 0.3*x^3 + 0.5*x^2*y + 0.2*x^2");
  workspace.succeed("run map -d map -c map -o up ICP=[q] DS=0.01 DSMAX=0.02 NMX=60 RL1=0.5 -q");
  workspace.succeed("run map -q -c r.up -s up -o doublings ISW=2 ICP=[p,q] IRS=PD1 DS=0.02 DSMAX=0.02 NMX=50");
  check_place(workspace, "doublings", "R2", 0.0, 0.0);
  CHECK(printed(workspace, "doublings", "R2", "c") == Approx(0.32).margin(coefficient_accuracy));
  CHECK(printed(workspace, "doublings", "R2", "d") == Approx(0.54).margin(coefficient_accuracy));
  // The derivative has the determinant 1 + p - q.
  workspace.succeed("run map -q -c r.doublings -s doublings -o tori IRS=R21 CURVE=TR DS=-0.02 NMX=40 NPR=1 RL0=-0.5");
  check_curve(workspace, "tori", [](double p) { return p; });
}

TEST_CASE("torus bifurcations of doubled orbits begin at a 1:2 resonance") {
  // (x, y) -> (-x + y, -(1 + p) y + q x + c x^3 + d x^2 y): doubled orbits, (x, 0) -> (-x, 0), have x^2 = -q / c; the
  // derivative at both points has the determinant 1 + p + (2 + d / c) q.
  const Workspace workspace;
  simulate(workspace, "par q=-0.05, p=-0.3\ninit x=0, y=0\nx' = 0\ny' = 0\n",
           "x -> -x + y, y -> -(1+p)*y + q*x - 0.3*x^3 + 0.5*x^2*y");
  workspace.succeed("run map -d map -c map -o up ICP=[q] DS=0.01 DSMAX=0.02 NMX=60 RL1=0.5 -q");
  workspace.succeed("run map -q -c r.up -s up -o doublings ISW=2 ICP=[p,q] IRS=PD1 DS=0.02 DSMAX=0.02 NMX=50");
  check_place(workspace, "doublings", "R2", 0.0, 0.0);
  begin(workspace, "born", "doublings", "R21", "0.01");
  check_curve(workspace, "born", [](double p) { return -p / (2.0 - 0.5 / 0.3); });
  CHECK(workspace.solutions("born").back().parameter(2) < -0.05);
}

TEST_CASE("coefficients of the 1:3 and the 1:4 resonance") {
  // z -> (1 + p) e^(i theta) z + B z*^2 + C z |z|^2 + D z*^3, B = 0.3 + 0.1 i, C = -0.5 - 0.2 i, D = 0.15 + 0.05 i;
  // with |q| = 1, z is sqrt(2) times the amplitude. At 1:4, z*^2 is removed first: C + 2 |B|^2 / (-1 + i) is left.
  const auto follow_tori = [](const Workspace& workspace, const std::string& angle) {
    simulate(workspace,
             "par p=-0.2, q=-0.3\ninit x=0, y=0\na = q + " + angle +
                 "\nc = (1+p)*cos(a)\ns = (1+p)*sin(a)\nr = x^2 + y^2\nx' = 0\ny' = 0\n",
             "x -> c*x - s*y + 0.3*(x^2-y^2) + 0.2*x*y - r*(0.5*x-0.2*y) + 0.15*(x^3-3*x*y^2) + 0.05*(3*x^2*y-y^3), "
             "y -> s*x + c*y + 0.1*(x^2-y^2) - 0.6*x*y - r*(0.5*y+0.2*x) - 0.15*(3*x^2*y-y^3) + 0.05*(x^3-3*x*y^2)");
    follow(workspace, "tori", "up", "TR1", "0.02");
  };
  using Complex = std::complex<double>;
  const Complex b(0.3, 0.1), c(-0.5, -0.2), d(0.15, 0.05);
  const Workspace third;
  follow_tori(third, "2*pi/3");
  check_place(third, "tori", "R3", 0.0, 0.0);
  const Complex mu = std::polar(1.0, 2.0 * std::acos(-1.0) / 3.0);
  CHECK(printed(third, "tori", "R3", "|b1|") ==
        Approx(3.0 * std::sqrt(2.0) * std::abs(b)).margin(coefficient_accuracy));
  CHECK(printed(third, "tori", "R3", "Re c1") ==
        Approx((6.0 * mu * mu * c).real() - 6.0 * std::norm(b)).margin(coefficient_accuracy));
  const Workspace fourth;
  follow_tori(fourth, "pi/2");
  check_place(fourth, "tori", "R4", 0.0, 0.0);
  const Complex c1 = Complex(0.0, -8.0) * (c + 2.0 * std::norm(b) / Complex(-1.0, 1.0));
  CHECK(printed(fourth, "tori", "R4", "Re c1") == Approx(c1.real()).margin(coefficient_accuracy));
  CHECK(printed(fourth, "tori", "R4", "Im c1") == Approx(c1.imag()).margin(coefficient_accuracy));
  CHECK(printed(fourth, "tori", "R4", "|d1|") == Approx(8.0 * std::abs(d)).margin(coefficient_accuracy));
}

TEST_CASE("Steinmetz and Larter's reaction: NS curve with the published Chenciner point") {
  // C. G. Steinmetz, R. Larter, J. Chem. Phys. 94, 1388 (1991); the point (1.757356, 0.9125773) is published for it, in
  // digits of which the last is uncertain: Re d is -6e-5 there, and zero 3.6e-6 farther on the same curve.
  const Workspace workspace;
  workspace.write("reaction.tch", R"(par k1=0.1631021, k2=1250, k3=0.046875, k4=20, k5=1.104, k6=0.001, k7=1.5
par km7=0.1175, k8=0.75
init A=31.78997, B=1.45468, X=0.01524586, Y=0.1776113
A' = -k1*A*B*X - k3*A*B*Y + k7 - km7*A
B' = -k1*A*B*X - k3*A*B*Y + k8
X' = k1*A*B*X - 2*k2*X^2 + 2*k3*A*B*Y - k4*X + k6
Y' = -k3*A*B*Y + 2*k2*X^2 - k5*Y
)");
  workspace.succeed("simulate reaction --free k8 --dat start -o sim -q");
  workspace.succeed("run reaction -q -c start -d start -o cycle NTST=60 NMX=60 DS=0.005 DSMAX=0.05 RL1=1");
  workspace.succeed(
      "run reaction -q -c r.cycle -s cycle -o curve IRS=TR1 ISW=2 ICP=[k7,k8] DS=0.01 DSMAX=0.1 NMX=60 "
      "RL1=1.9");
  const SolutionEntry point = only(workspace, "curve", "CH");
  CHECK(std::abs(point.parameter(7) - 1.757356) < 5e-6);
  CHECK(std::abs(point.parameter(9) - 0.9125773) < 1e-6);
}

TEST_CASE("a curve of torus bifurcations begins at a double Hopf point") {
  // Amplitudes r' = (m1 - r^2 - 0.3 s^2) r, s' = (m2 + 0.4 r^2 - s^2) s: the cycle r^2 = m1 loses stability at m1 = -m2
  // / 0.4, down to the point where both are zero.
  const Workspace workspace;
  workspace.write("map.tch", R"(par p=-0.2, q=-0.5
init x=0, y=0, u=0, v=0
r = x^2 + y^2
s = u^2 + v^2
x' = (p - r - 0.3*s)*x - 1.7*y
y' = (p - r - 0.3*s)*y + 1.7*x
u' = (q + 0.4*r - s)*u - v
v' = (q + 0.4*r - s)*v + u
)");
  follow_rest(workspace);
  follow_cycle(workspace);
  follow(workspace, "tori", "cycle", "TR1", "0.02", "DSMAX=0.05 RL0=-2");
  check_curve(workspace, "tori", [](double q) { return -q / 0.4; });
  CHECK(std::abs(workspace.solutions("tori").back().parameter(2)) < accuracy);
  // The cycle s^2 = m2 loses stability at m1 = 0.3 m2. Both Hopf curves, p = 0 and q = 0, go through the point.
  follow(workspace, "hopf", "rest", "HB1", "0.02");
  check_place(workspace, "hopf", "HH", 0.0, 0.0);
  check_curve(workspace, "hopf", [](double) { return 0.0; });
  begin(workspace, "fast", "hopf", "HH1", "0.05", "IPS=180 MODE=2");
  check_curve(workspace, "fast", [](double q) { return -q / 0.4; });
  begin(workspace, "slow", "hopf", "HH1", "0.05", "IPS=180 MODE=1");
  check_curve(workspace, "slow", [](double q) { return 0.3 * q; });
  workspace.succeed("run map -q -c r.hopf -s hopf -o other IRS=HH1 MODE=1 ICP=[p,q] DS=0.02 NMX=20 NPR=1");
  const std::vector<SolutionEntry> other = workspace.solutions("other");
  REQUIRE(other.size() > 10);
  for (const SolutionEntry& point : other) CHECK(std::abs(point.parameter(2)) < accuracy);
  CHECK(workspace.tchat("run map -c r.hopf -s hopf -o none IRS=HH1 ISW=2 MODE=3").err.find("MODE = 3") !=
        std::string::npos);
}

TEST_CASE("a curve of torus bifurcations begins at a zero-Hopf point") {
  // z' = q + z^2 + r^2, r' = (p - z + z^2) r: the cycle r^2 = -q - z^2 has the trace 2 z, zero at p = 0.
  const Workspace workspace;
  workspace.write("map.tch", R"(par p=-1.5, q=-0.4
init z=-0.6, x=0, y=0
r = x^2 + y^2
z' = q + z^2 + r
x' = (p - z + z^2)*x - 1.3*y
y' = (p - z + z^2)*y + 1.3*x
)");
  follow_rest(workspace);
  follow_cycle(workspace);
  follow(workspace, "tori", "cycle", "TR1", "0.02", "DSMAX=0.05");
  check_curve(workspace, "tori", [](double) { return 0.0; });
  CHECK(std::abs(workspace.solutions("tori").back().parameter(2)) < accuracy);
  follow(workspace, "hopf", "rest", "HB1", "0.02");
  check_place(workspace, "hopf", "ZH", 0.0, 0.0);
  begin(workspace, "born", "hopf", "ZH1", "0.05", "IPS=180");
  check_curve(workspace, "born", [](double) { return 0.0; });
  CHECK(workspace.solutions("born").back().parameter(2) < -0.1);
}

TEST_CASE("at a Bogdanov-Takens point the curve of Hopf points is followed") {
  // Kuznetsov's normal form: folds p = q^2 / 4, Hopf points p = 0, q < 0.
  const Workspace workspace;
  workspace.write("map.tch", "par p=0.1, q=-1\ninit x=0.11, y=0\nx' = y\ny' = p + q*x + x^2 - x*y\n");
  follow_rest(workspace);
  follow(workspace, "folds", "rest", "LP1", "0.02", "RL0=-2");
  check_place(workspace, "folds", "BT", 0.0, 0.0);
  check_curve(workspace, "folds", [](double q) { return 0.25 * q * q; });
  follow(workspace, "hopf", "folds", "BT1", "-0.02", "CURVE=HB");
  check_curve(workspace, "hopf", [](double) { return 0.0; });
  CHECK(workspace.tchat("run map -c r.folds -s folds -o x IRS=BT1 CURVE=TR").err.find("CURVE = TR") !=
        std::string::npos);
}

TEST_CASE("a curve of folds of periodic orbits begins at a generalised Hopf point") {
  // r' = (p + q r^2 - r^4) r: two cycles meet at r^2 = q / 2, p = -q^2 / 4.
  const Workspace workspace;
  workspace.write("map.tch", R"(par p=-0.3, q=0.4
init x=0, y=0
r = x^2 + y^2
x' = (p + q*r - r^2)*x - 1.3*y
y' = (p + q*r - r^2)*y + 1.3*x
)");
  follow_rest(workspace);
  follow(workspace, "hopf", "rest", "HB1", "-0.02");
  check_place(workspace, "hopf", "GH", 0.0, 0.0);
  check_curve(workspace, "hopf", [](double) { return 0.0; });
  follow_cycle(workspace);
  follow(workspace, "folds", "cycle", "LP1", "-0.02");
  check_curve(workspace, "folds", [](double q) { return -0.25 * q * q; });
  CHECK(std::abs(workspace.solutions("folds").back().parameter(2)) < 1e-4);  // an orbit that shrinks like sqrt(q)
  begin(workspace, "born", "hopf", "GH1", "0.05", "IPS=180");
  check_curve(workspace, "born", [](double q) { return -0.25 * q * q; });
  CHECK(workspace.solutions("born").back().parameter(2) > 0.4);
}

// What a run claims has evidence: functions that vanish identically have no zeros, an orbit tends to a homoclinic one
// where it comes near an equilibrium, a start that is a special point is said to be one, rounding is written as 0.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

std::string out_of(const Workspace& workspace, const std::vector<std::string>& words) {
  const Outcome outcome = workspace.tchat(words);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome.out;
}

/// A forced mass slips on a belt of velocity V until it has that velocity. Its velocity is w - 0.3 q^2: g_x f is f
/// where it touches V without acceleration, up to rounding that changes its sign along the curve.
constexpr const char* belt = R"(par A=0.5, omega=1.5, V=1, zeta=0.05, F=1
init q=1, w=0.3, s=0, c=1
growth = 1 - s^2 - c^2
v = w - 0.3*q^2
force = F + A*c - 2*zeta*v - q
q' = v
s' = growth*s + omega*c
c' = growth*c - omega*s
field slip
w' = force + 0.6*q*v
field stick
w' = 0.6*q*v
event catch = V - v
event fastest = force
event release = force
jump hold: w -> V + 0.3*q^2
after catch: stick until release -> identity
after any: slip until catch -> hold, fastest -> identity
)";

/// Thrown up from an elastic floor with a lift xi v: at xi = 0 one orbit for each energy, of period 2 v / g.
constexpr const char* ball = R"(par g=1, xi=0
init y=1, v=0
y' = v
v' = -g + xi*v
event floor = y
jump bounce: v -> -v
after any: floor -> bounce
)";

/// x'' = x - x^2 + (mu + x) x': the orbits around (1, 0) end at a homoclinic orbit of the saddle (0, 0) where
/// mu = -0.86454525 (by shooting from its manifolds).
constexpr const char* loop = R"(par mu=-0.95
init x=1.3737, v=0
x' = v
v' = x - x^2 + mu*v + x*v
event right = v
after any: right -> identity
)";

/// FitzHugh's neuron: its cycles end in a canard, where the period and the multipliers depend on I steeply.
constexpr const char* canard = R"(par I=0.5, a=0.7, b=0.8, e=0.08
init v=1, w=0.5
v' = v - v^3/3 - w + I
w' = e*(v + a - b*w)
event section = v
after any: section -> identity
)";

}  // namespace

TEST_CASE("a xi_n that beta = 0 makes zero is said once, and has no labels") {
  const Workspace workspace;
  workspace.write("belt.tch", belt);
  out_of(workspace, {"simulate", "belt", "--dat", "free"});
  out_of(workspace,
         {"run", "belt", "-c", "free", "-d", "free", "-o", "free", "ICP=[A]", "DS=0.02", "DSMAX=0.2", "RL1=3"});
  out_of(workspace, {"resegment", "q.free", "GR1", "--to", "grazing-curve", "-o", "start", "-p", "belt",
                     "ICP=[omega,A]", "RL0=1.2", "RL1=4", "NMX=60", "DSMAX=0.3"});
  const std::string curve =
      out_of(workspace, {"run", "belt", "-c", "start", "-s", "start", "-o", "curve", "GCIPSI=[1,2,3]"});
  INFO(curve);
  CHECK_FALSE(contains(curve, "codimension two"));
  CHECK(contains(curve, "xi_1, xi_2, xi_3; beta = 0"));
  // Nothing holds steps back: the curve is followed to its bound.
  CHECK(contains(curve, "omega left the bounds"));
  // A omega = V |1 - omega^2 + 2 i zeta omega| all along the curve.
  const PointSection section = workspace.points("curve").front();
  for (const PointRow& row : section.rows) {
    const double omega = row.values[section.column("omega")], A = row.values[section.column("A")];
    CHECK(A * omega == Approx(std::hypot(1.0 - omega * omega, 0.1 * omega)).epsilon(1e-7));
  }
  CHECK(contains(out_of(workspace, {"grazing", "q.free", "GR1", "-p", "belt"}), "beta = 0"));
}

TEST_CASE("a family of one orbit for each energy tends to no homoclinic orbit") {
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  workspace.write("gc.ball",
                  "NDIM = 2, IPS = 180, IRS = 0\nICP = [xi]\nNTST = 10, NMX = 60, DS = 0.05, DSMAX = 0.5\n"
                  "GCFIND = [1], GCHIND = [1], GCGIND = [1]\n");
  std::string data;
  for (int k = 0; k <= 20; ++k) {
    const double t = 0.1 * k;
    data += std::to_string(t) + " " + std::to_string(t - 0.5 * t * t) + " " + std::to_string(1.0 - t) + "\n";
  }
  workspace.write("ball.dat", data);
  const std::string out = out_of(workspace, {"run", "ball"});
  INFO(out);
  REQUIRE(rows_of(workspace.points("ball")).back().values.back() > 10.0);  // the period, of 2 at the start
  CHECK_FALSE(contains(out, "clinic"));
}

TEST_CASE("a homoclinic orbit is said with the equilibrium that the orbit comes near") {
  const Workspace workspace;
  workspace.write("loop.tch", loop);
  out_of(workspace, {"simulate", "loop", "--dat", "loop"});
  const std::string out = out_of(workspace, {"run", "loop", "-c", "loop", "-d", "loop", "DS=0.02", "DSMAX=0.2",
                                             "NMX=120", "NTST=60", "EPSL=1e-8", "EPSU=1e-8"});
  INFO(out);
  CHECK(contains(out, "homoclinic or heteroclinic orbit"));
  CHECK(contains(out, "x = 0, v = 0"));
  // lambda^2 - mu lambda - 1 = 0
  CHECK(contains(out, "0.65715"));
  CHECK(contains(out, "-1.5217"));
}

TEST_CASE("a start that is a special point is said to be one") {
  const Workspace workspace;
  workspace.write("fold.tch", "par mu=1\ninit x=1\nx' = mu - x^2\n");
  workspace.write("fold.dat", "1\n");
  workspace.write("gc.fold", "NDIM = 1, IPS = 1, IRS = 0\nICP = [mu]\nNMX = 30, DS = -0.05, DSMAX = 0.1, RL1 = 2\n");
  out_of(workspace, {"run", "fold", "-o", "branch"});
  const std::string repeated = out_of(workspace, {"run", "fold", "-s", "branch", "-o", "next", "NMX=3", "IRS=LP1"});
  INFO(repeated);
  CHECK(contains(repeated, "Start: label 2 of q.branch, itself a special point (LP)"));
  CHECK(contains(repeated, "DS < 0: back against the direction stored with label 2 of q.branch"));
  CHECK(contains(repeated, "DS=0.05 continues the earlier run"));
  CHECK_FALSE(contains(out_of(workspace, {"run", "fold", "-s", "branch", "-o", "next", "NMX=3", "IRS=EP2"}), "itself"));
}

TEST_CASE("states below their accuracy are written as 0") {
  const Workspace workspace;
  // Cut at a maximum of x1, where x2 is 0 to within rounding.
  const std::string found = out_of(workspace, {"simulate", "linosc", "PAR(alpha)=2", "PAR(omega)=2.0072"});
  INFO(found);
  CHECK(contains(found, "x2 = 0,"));
  // The equilibrium x = 1, v = -5e-324 touches the wall at mu = -1.
  workspace.write("line.tch", "par mu=0\ninit x=1, v=0\nx' = 1 - x\nv' = -v - 5e-324*x\nevent wall = 2 - x + mu\n");
  workspace.write("line.dat", "1 -4.94e-324\n");
  workspace.write("gc.line",
                  "NDIM = 2, IPS = 1, IRS = 0\nICP = [mu]\nNMX = 30, DS = -0.1, DSMAX = 0.2, RL0 = -3\n"
                  "GCHGRZIND = [[1]]\n");
  const std::string out = out_of(workspace, {"run", "line"});
  INFO(out);
  CHECK(contains(out, "x = 1, v = 0"));
  CHECK_FALSE(contains(out, "e-324"));
}

TEST_CASE("a Hopf curve that meets its mirror image ends there, in a Bogdanov-Takens point") {
  // Takens' normal form with x -> -x: x = a, p = q = a^2, omega^2 = 2 a^2, along which omega touches zero at the
  // origin.
  const Workspace workspace;
  workspace.write("takens.tch", "par p=0.04, q=0.03\ninit x=0.2, y=0\nx' = y\ny' = p*x + q*y - x^2*(x + y)\n");
  workspace.write("takens.dat", "0.2 0\n");
  workspace.write("gc.takens",
                  "NDIM = 2, IPS = 1, IRS = 0\nICP = [q]\nNMX = 30, DS = 0.005, DSMAX = 0.02, RL1 = 0.06\n");
  out_of(workspace, {"run", "takens", "-o", "equilibria"});
  for (const std::string longest : {"0.003", "0.1"}) {
    const std::string out =
        out_of(workspace, {"run", "takens", "-c", "r.equilibria", "-s", "equilibria", "-o", "curve", "IRS=HB1", "ISW=2",
                           "ICP=[p,q]", "DS=-0.002", "DSMAX=" + longest, "NMX=200", "RL0=-0.1", "RL1=0.2"});
    INFO(out);
    CHECK(contains(out, "BT label"));
    const SolutionEntry end = workspace.solutions("curve").back();
    CHECK(std::abs(end.parameter(1)) < 1e-8);
    CHECK(std::abs(end.parameter(2)) < 1e-8);
  }
}

TEST_CASE("a label's own orbit has the multiplier of its type, also where orbits change fast") {
  const Workspace workspace;
  workspace.write("canard.tch", canard);
  out_of(workspace, {"simulate", "canard", "--dat", "canard"});
  const std::string out =
      out_of(workspace, {"run", "canard", "-c", "canard", "-d", "canard", "NTST=15", "DS=0.02", "DSMAX=0.231",
                         "DSMIN=0", "NMX=150", "NPR=10", "RL0=0.2", "RL1=1.6", "ICP=[I,multiplier(1)]"});
  INFO(out);
  for (const PointSection& section : workspace.points("canard"))
    for (const PointRow& row : section.rows) {
      if (row.type < 5 || row.type > 7) continue;
      CAPTURE(row.label, row.type);
      CHECK(std::abs(row.values[section.column("multiplier(1)")] - (row.type == 7 ? -1.0 : 1.0)) < 0.05);
    }
  // Its one multiplier changes fast, and what the mesh makes of it has no label.
  CHECK(contains(out, "no label"));
}

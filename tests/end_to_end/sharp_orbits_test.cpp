// Orbits with the shortest and the longest parts: spikes for which times have hardly any digits, two events at one
// instant, a period that grows without bound where equilibria are born on the orbit.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// The adaptive exponential neuron of Brette and Gerstner in pF, nS, mV, pA and ms; `further`: lines of its own.
std::string neuron(const std::string& further) {
  return R"(par I=700, b=80.5, Vpeak=0, a=4
number C=281, gL=30, EL=-70.6, VT=-50.4, DT=2, tw=144, Vr=-60
init V=-65, w=50
V' = (-gL*(V - EL) + gL*DT*exp((V - VT)/DT) - w + I)/C
w' = (a*(V - EL) - w)/tw
event spike = Vpeak - V
jump reset: V -> Vr, w -> w + b
)" + further;
}

/// The last number of the first row of a branch: its period.
double first_period(const std::string& branch) {
  const std::size_t header = branch.find("PERIOD");
  REQUIRE(header != std::string::npos);
  const std::size_t row = branch.find('\n', header) + 1;
  const std::string line = branch.substr(row, branch.find('\n', row) - row);
  return std::stod(line.substr(line.find_last_of(' ') + 1));
}

}  // namespace

TEST_CASE("A spike cut at 0 mV, where V rises by 2e10 mV/ms: simulated, continued and verified") {
  const Workspace workspace;
  workspace.write("adex.tch", neuron("after any: spike -> reset\n"));
  const std::string out = workspace.succeed("simulate adex --dat s").out;
  CHECK(out.find("negative") == std::string::npos);
  workspace.succeed("run adex -c s -d s -o b ICP=[I] DS=1 DSMAX=50 NMX=20 -q");
  // By integration at a tolerance of 1e-12, with V instead of t as the independent variable where it rises.
  CHECK(first_period(workspace.read("p.b")) == Approx(131.18618959924).epsilon(1e-9));
  CHECK(workspace.succeed("verify q.b").out.find("2 labels agree") != std::string::npos);
  // From its file, too.
  workspace.succeed("run adex -c s -s b IRS=EP2 -o further NMX=3 -q");
  CHECK(workspace.succeed("verify q.further").out.find("1 label agrees") != std::string::npos);
}

TEST_CASE("A spike for which times have too few digits is not written: an event that divides it cures that") {
  const Workspace workspace;
  workspace.write("adex.tch", neuron("after any: spike -> reset\n"));
  const auto refused = workspace.tchat("simulate adex PAR(Vpeak)=20 --dat s -q");
  CHECK(refused.status == 1);
  CHECK(refused.err.find("divide it by an event that changes nothing, as at V = -28") != std::string::npos);
  workspace.write("cut.tch", neuron("event cut = -28 - V\nafter start: cut -> identity\nafter spike: cut -> identity\n"
                                    "after cut: spike -> reset\n"));
  workspace.succeed("simulate cut PAR(Vpeak)=20 --dat c -q");
  workspace.succeed("run cut -c c -d c -o c ICP=[I] DS=1 DSMAX=5 NMX=5 -q");
  CHECK(workspace.succeed("verify q.c").out.find("2 labels agree") != std::string::npos);
}

TEST_CASE("Two oscillators hit their walls together: the orbit with a segment of no duration is found and continued") {
  const Workspace workspace;
  // The linear oscillator of the dissertation twice, so that each has its orbits; k couples them and is zero on these.
  workspace.write("twins.tch", R"(par alpha=3.2, omega=2.0072, zeta=0.05, r=0.8, k=0
init y2=1
growth = 1 - y1^2 - y2^2
x' = v
v' = alpha*y2 - 2*zeta*v - x + k*(z - x)
z' = w
w' = alpha*y2 - 2*zeta*w - z + k*(x - z)
y1' = growth*y1 + omega*y2
y2' = growth*y2 - omega*y1
event wall1 = 1 - x
event wall2 = 1 - z
jump hit1: v -> -r*v
jump hit2: w -> -r*w
after any: wall1 -> hit1, wall2 -> hit2
)");
  const std::string out = workspace.succeed("simulate twins --dat s").out;
  CHECK(out.find("flow for 0 until wall2") != std::string::npos);
  CHECK(out.find("negative") == std::string::npos);
  const std::string branch =
      workspace.succeed("run twins -c s -d s -o b ICP=[alpha] DS=-.02 DSMAX=.5 RL0=2.95 NMX=200 UZR={alpha:3.0358}")
          .out;
  INFO(branch);
  // Both double their periods where one does alone: alpha = 3.036193566 in closed form.
  CHECK(branch.find("at alpha = 3.036193566: period doubling: 2 multipliers go through -1 together") !=
        std::string::npos);
  CHECK(workspace.succeed("verify q.b").out.find("agree") != std::string::npos);
}

TEST_CASE("A period grows without bound towards a fold of equilibria on the orbit, and the run says so") {
  // The theta neuron: T = pi / sqrt(a).
  const Workspace workspace;
  workspace.write("theta.tch", R"(par a=0.5
number turn=6.283185307179586
init th=0
th' = 1 - cos(th) + (1 + cos(th))*a
event round = turn - th
jump reset: th -> th - turn
after any: round -> reset
)");
  workspace.succeed("simulate theta --dat s -q");
  const std::string out = workspace.succeed("run theta -c s -d s -o b ICP=[a] DS=-.02 DSMAX=.2 NMX=200 RL0=-1").out;
  INFO(out);
  CHECK(out.find("fold of the equilibria") != std::string::npos);
  CHECK(out.find("you might") == std::string::npos);
}

TEST_CASE("Limit of chattering on a vibrating table: no more digits than it has") {
  // x'' = -1 on a table 1.1 sin(t), r = 1/2. By iteration of the flights in 40 digits the limit is 5.311288054231.
  const Workspace workspace;
  workspace.write("table.tch", R"(par Gamma=1.1, r=0.5
init x=0.1, v=0, s=0
x' = v
v' = -1
s' = 1
event floor = x - Gamma*sin(s)
jump impact: v -> -r*v + (1 + r)*Gamma*cos(s)
after any: floor -> impact
)");
  for (const auto* const tolerance : {"1e-8", "1e-10", "1e-13"}) {
    const std::string out = workspace.succeed(std::string("simulate table --tolerance ") + tolerance).out;
    INFO(out);
    const std::size_t at = out.find("limit is at t = ");
    REQUIRE(at != std::string::npos);
    std::istringstream words(out.substr(at + 16));
    double limit = 0.0, uncertainty = 0.0;
    std::string sign;
    words >> limit >> sign >> uncertainty;
    CHECK(std::abs(limit - 5.311288054231) <= uncertainty);
    CHECK(uncertainty < 1e5 * std::stod(tolerance));
  }
}

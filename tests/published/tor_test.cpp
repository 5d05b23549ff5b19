// The electronic oscillator of Freire, Rodriguez-Luis, Gamero and Ponce (Physica D 62, 1993), which is also AUTO-07p's
// demo tor. Orbits are symmetric under (x, y, z) -> -(x, y, z); the torus curve of those that are not meets its mirror
// image at the symmetric orbit, in the 1:1 resonance, and ends at the other side in a Hopf bifurcation of the origin at
// nu = -beta = -0.6, omega^2 = 0.4 (trace and determinant of the linearisation). AUTO-07p places the resonance at
// nu = -.59730759, beta = .44807986, to about 1e-6; the fold curve of the symmetric orbits, on which all three
// multipliers are 1 there, goes through the same point.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* oscillator = R"(par nu=-0.9, be=0.5, ga=-0.6, r=0.6, a3=0.328578, b3=0.933578
init x=0, y=0, z=0
x' = (-(be + nu)*x + be*y - a3*x^3 + b3*(y - x)^3)/r
y' = be*x - (be + ga)*y - z - b3*(y - x)^3
z' = y
)";

}  // namespace

TEST_CASE("the torus curve of asymmetric orbits ends at its mirror image, in the 1:1 resonance") {
  const Workspace workspace;
  workspace.write("tor.tch", oscillator);
  workspace.write("tor.dat", "0 0 0\n");
  workspace.write("gc.tor",
                  "NDIM = 3, IPS = 1, IRS = 0\nICP = [nu]\nNMX = 20, RL0 = -1, RL1 = 0\nDS = 0.01, DSMAX = 0.05\n");
  const auto run = [&](const std::string& arguments) {
    const Outcome outcome = workspace.tchat("run tor " + arguments);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
    return outcome.out;
  };
  run("-o equilibria");
  run("-c r.equilibria -s equilibria -o cycles IRS=HB1 IPS=180 ISW=-1 DS=0.02 DSMAX=0.2 NTST=40 IAD=3 NMX=20 RL1=1");
  run("-c r.cycles -s cycles -o asymmetric IRS=BP1 ISW=-1 DS=0.01 DSMAX=0.1 NMX=30 STOP=[TR1]");
  int resonances = 0;
  double nu = 0.0, beta = 0.0;
  for (const std::string longest : {"0.01", "0.05", "0.2"})
    for (const std::string sign : {"", "-"}) {
      const std::string out = run("-c r.asymmetric -s asymmetric -o curve IRS=TR1 ISW=2 ICP=[nu,be] DS=" + sign +
                                  "0.005 DSMAX=" + longest + " NMX=150");
      CAPTURE(longest, sign);
      INFO(out);
      CHECK(out.find("may be missing") == std::string::npos);
      CHECK(out.find("neutral saddles") == std::string::npos);
      const SolutionEntry end = workspace.solutions("curve").back();
      if (out.find("R1 label") == std::string::npos) {
        CHECK(std::abs(end.parameter(1) + 0.6) < 1e-3);
        CHECK(std::abs(end.parameter(2) - 0.6) < 1e-3);
        continue;
      }
      ++resonances;
      CHECK(std::abs(end.parameter(1) + 0.59730759) < 2e-6);
      CHECK(std::abs(end.parameter(2) - 0.44807986) < 2e-6);
      nu = end.parameter(1), beta = end.parameter(2);
    }
  CHECK(resonances == 3);
  run(
      fmt::format("-c r.cycles -s cycles -o folds IRS=LP1 ISW=2 ICP=[nu,be] DS=-0.005 DSMAX=0.05 NMX=60 RL0=-0.7 "
                  "UZR={{be:{:.12f}}} STOP=[UZ1]",
                  beta));
  const SolutionEntry fold = workspace.solutions("folds").back();
  CHECK(std::abs(fold.parameter(2) - beta) < 2e-8);
  CHECK(std::abs(fold.parameter(1) - nu) < 1e-8);  // both are located to EPSS, 1e-7 of the arclength
}

// What simulations say of motions that settle on nothing, or on it so slowly that nobody can tell.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>

#include "end_to_end/bad_input.hpp"
#include "published/chain.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A map u -> `jump`, once in each unit of time.
std::string map_of(const std::string& parameters, const std::string& jump) {
  return "par " + parameters +
         "\ninit tau=0, u=0.3\ntau' = 1\nu' = 0\nevent tick = 1 - tau\njump apply: tau -> 0, u -> " + jump +
         "\nafter any: tick -> apply\n";
}

/// What the three commands say, each on its own.
struct Said {
  std::string simulated, exponents, swept;

  bool has_claim(const std::string& part) const {
    return contains(simulated, part) || contains(exponents, part) || contains(swept, part);
  }
};

Said said_of(const Workspace& workspace, const std::string& formulas, const std::string& parameter,
             const std::string& start) {
  workspace.write("motion.tch", formulas);
  const std::string name = parameter.substr(0, parameter.find('='));
  const std::string value = parameter.substr(parameter.find('=') + 1);
  const std::string at = " --state " + start + " --rows 0 PAR(" + name + ")=" + value;
  Said said;
  said.simulated = workspace.succeed("simulate motion" + at).out;
  said.exponents = workspace.succeed("simulate motion --lyapunov" + at).out;
  said.swept = workspace
                   .succeed("sweep motion --over " + name + "=" + value + ":" + value +
                            ":1 --section none --fresh --state " + start)
                   .out;
  return said;
}

}  // namespace

TEST_CASE("below its fold no orbit of period 3 is claimed, however slowly the motion passes") {
  const Workspace workspace;
  for (const char* const a : {"3.82842712474615", "3.828427119"}) {  // 1 + sqrt 8 - 4e-14, - 6e-9
    INFO(a);
    const Said said = said_of(workspace, map_of("a=3.2", "a*u*(1-u)"), std::string("a=") + a, "u=0.3");
    INFO(said.simulated << said.exponents << said.swept);
    CHECK_FALSE(contains(said.simulated, "Periodic orbit"));
    CHECK_FALSE(contains(said.swept, "Attractor 1: periodic"));
    CHECK_FALSE(contains(said.exponents, "negative: a stable periodic orbit"));
  }
  // Above the fold there is one, and it attracts.
  const Said said = said_of(workspace, map_of("a=3.2", "a*u*(1-u)"), "a=3.829", "u=0.3");
  CHECK(contains(said.swept, "Attractor 1: periodic, {(1,1,1)}^3"));
}

TEST_CASE("closed orbits of a family are told as such, and are no attractors") {
  const Workspace workspace;
  // x'' = -x^3 from (1.2, 0): T = 4 K(1/2) / 1.2, K the complete elliptic integral with k^2 = 1/2.
  const Said said =
      said_of(workspace, "par c=1\ninit x=1.2, v=0\nx' = v\nv' = -c*x^3\nevent turn = v\nafter any: turn -> identity\n",
              "c=1", "1.2,0");
  INFO(said.simulated << said.exponents << said.swept);
  CHECK(contains(said.simulated, "neutral, the largest modulus is 1"));
  const std::size_t at = said.simulated.find("period ");
  REQUIRE(at != std::string::npos);
  const double period = std::stod(said.simulated.substr(at + 7));
  CHECK(period == Approx(4.0 * std::comp_ellint_1(std::numbers::sqrt2 / 2.0) / 1.2).epsilon(1e-6));
  CHECK(contains(said.exponents, "They are those of the orbit that the motion keeps to, which is neutral."));
  CHECK(contains(said.swept, "No attractor: 1 times"));
  CHECK(contains(said.swept, "a periodic orbit of a family: those beside it are closed as well"));
  CHECK(contains(workspace.read("motion.sweep"), " neutral 1 6."));
}

TEST_CASE("a rotation by a jump with mod is no drift, and no attractor") {
  const Workspace workspace;
  const Said said = said_of(workspace, map_of("om=0.3", "mod(u + om, 1)"), "om=0.38196601125", "u=0.1");
  INFO(said.simulated << said.exponents << said.swept);
  CHECK_FALSE(said.has_claim("which nothing depends on"));
  CHECK_FALSE(said.has_claim("Attractor 1"));
  CHECK(contains(said.exponents, "2 zero exponents, none positive, and volumes are kept"));
  // Without mod it is one: no function depends on where u is.
  const Said drifting = said_of(workspace, map_of("om=0.3", "u + om"), "om=0.38196601125", "u=0.1");
  CHECK(contains(drifting.simulated, "u, which nothing depends on, advances by 0.38196601125"));
}

TEST_CASE("a motion that grows like a power of time is on no attractor, and no torus") {
  const Workspace workspace;
  const Said said =
      said_of(workspace,
              "par d=0.3\ninit a=1, b=0, X=0, Y=0\ng = 1-a^2-b^2\na' = g*a - b\nb' = g*b + a\nX' = a + d\n"
              "Y' = X\nevent turn = b\nafter any: turn -> identity\n",
              "d=0.2", "1,0,0,0");
  INFO(said.simulated << said.exponents << said.swept);
  CHECK(contains(said.simulated, "the range of X still grows"));
  CHECK(contains(said.exponents, "undecided: the range of X still grows"));
  CHECK(contains(said.swept, "the range of X still grows"));
  CHECK_FALSE(said.has_claim("Attractor 1"));
  CHECK_FALSE(said.has_claim("torus of dimension 2,"));
}

TEST_CASE("exponents of an unstable orbit that the motion keeps to are no chaos") {
  // In binary numbers the angle is 0 after 53 doublings.
  const Workspace workspace;
  const Said said = said_of(workspace, map_of("b=2", "mod(b*u, 1)"), "b=2", "u=0.3");
  INFO(said.simulated << said.exponents << said.swept);
  CHECK(contains(said.exponents, "They are those of the orbit that the motion keeps to, which is not stable."));
  CHECK_FALSE(said.has_claim("the motion is chaotic"));
  CHECK_FALSE(said.has_claim("Attractor 1"));
}

TEST_CASE("chaos that other starts leave is perhaps a transient") {
  // (4 + e) u (1 - u) leaves [0, 1] near u = 1/2, with a mean life of about pi / sqrt(e) = 2,000 events, and then goes
  // to -0.6.
  const Workspace workspace;
  workspace.write("leak.tch", map_of("e=2.5e-6", "heav(u)*(4 + e)*u*(1-u) + (1 - heav(u))*(u/2 - 0.3)"));
  const std::string leaking =
      workspace.succeed("sweep leak --over u=0.02:0.98:40 --section none --fresh PAR(e)=2.5e-6").out;
  INFO(leaking);
  CHECK(contains(leaking, "Attractor 1: periodic"));
  CHECK_FALSE(contains(leaking, "Attractor 2"));
  CHECK(contains(leaking, ": perhaps a transient"));
  // Without a hole it is chaotic, and for how long it was seen is told.
  workspace.write("whole.tch", map_of("a=3.99", "a*u*(1-u)"));
  const std::string whole = workspace.succeed("sweep whole --over a=3.99:3.99:1 --section none --fresh").out;
  INFO(whole);
  CHECK(contains(whole, "Attractor 1: chaotic, seen for "));
}

TEST_CASE("exponents of a weakly stable orbit are those of the orbit") {
  // r' = -r (r^2 - 1) (r^2 - 1.002001): the cycle r = 1 has the multiplier exp(-0.002001 2 2 pi).
  const Workspace workspace;
  workspace.write("weak.tch",
                  "par e=0.002001\ninit x=1, y=0\nr2 = x^2 + y^2\ng = (r2 - 1)*(r2 - 1 - e)\nx' = g*x - y\n"
                  "y' = g*y + x\nevent turn = y\nafter any: turn -> identity\n");
  const std::string out = workspace.succeed("simulate weak --state 0.99,0 --lyapunov --rows 0").out;
  INFO(out);
  const std::size_t at = out.find("   2  ");
  REQUIRE(at != std::string::npos);
  const double exponent = std::stod(out.substr(at + 6));
  const double bar = std::stod(out.substr(out.find("+- ", at) + 3));
  CHECK(std::abs(exponent + 0.004002) < 4.0 * bar);
  CHECK(bar < 1e-6);
}

TEST_CASE("exponents do not depend on how small a state has become") {
  // Beside a cycle with the exponents 0 and -2, z' = -1.4e-7 z is corrected to rounding.
  const Workspace workspace;
  workspace.write("slow.tch",
                  "par e=1.4e-7\ninit x=1, y=0, z=0.8\ng = 1 - x^2 - y^2\nx' = g*x - y\ny' = g*y + x\nz' = -e*z\n"
                  "event turn = y\nafter any: turn -> identity\n");
  const std::string out = workspace.succeed("simulate slow --lyapunov --rows 0").out;
  INFO(out);
  CHECK(contains(out, "   3  -2.00000000") != contains(out, "   3  -1.99999999"));
}

TEST_CASE("an equilibrium is not refined to an orbit") {
  const Workspace workspace;
  workspace.write("spiral.tch",
                  "par m=-1.2, w=2\ninit x=0.9, y=0.01\nr2 = x^2 + y^2\nx' = m*x - w*y + x*r2\ny' = w*x + m*y + y*r2\n"
                  "event turn = y\nafter any: turn -> identity\n");
  const auto outcome = workspace.tchat("simulate spiral --refine --dat found");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  CHECK(contains(outcome.out, "finds no periodic orbit: shooting went to an equilibrium"));
}

TEST_CASE("a multiplier on the unit circle all along is neither stable nor unstable") {
  const Workspace workspace;
  workspace.write(
      "rotation.tch",
      "par th=1\nu' = 0\nv' = 0\nt' = 1\nevent tick = 1 - t\n"
      "jump step: u -> cos(th)*u - sin(th)*v, v -> sin(th)*u + cos(th)*v, t -> 0\nafter any: tick -> step\n");
  REQUIRE(workspace.tchat("simulate rotation --dat s").status == 0);
  const Outcome run = workspace.tchat("run rotation -c s -d s -o b NMX=6 DS=0.05");
  INFO(run.text());
  CHECK(run.out.find("6 points, 0 stable, 0 unstable and 6 neutral (a multiplier of modulus 1)") != std::string::npos);
}

TEST_CASE("a watched event that is negative all along is said where the motion settles on nothing") {
  const Workspace workspace;
  const auto converter = [](const std::string& peak) {
    return "par ref=2.5\ninit i=1, t=0\ni' = 1\nt' = 1\nevent peak = " + peak +
           "\nevent tick = 1 - t\njump clock: t -> 0\njump off: i -> 0.3*i\n"
           "after any: peak -> off, tick -> clock\n";
  };
  workspace.write("converter.tch", converter("0.5 - i"));  // the current begins above
  CHECK(contains(workspace.succeed("simulate converter").out,
                 "event 1 (peak) is not positive when segment 1 begins and negative when it ends, and so in 10000 of"));
  workspace.write("converter.tch", converter("ref - i"));
  CHECK_FALSE(contains(workspace.succeed("simulate converter").out, "not positive when"));
}

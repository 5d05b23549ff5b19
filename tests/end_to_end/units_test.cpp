// Nothing depends on units: the same problem in other ones has the same events, orbits and special points.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/event_list.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The forced oscillator of the tutorial with a wall at x = u: x and v are proportional to u.
std::string oscillator(const std::string& u) {
  return "par alpha=3.2, omega=2.0072, zeta=0.05, r=0.8\nnumber u=" + u +
         "\ninit y2=1\ngrowth = 1 - y1^2 - y2^2\nx' = v\nv' = u*alpha*y2 - 2*zeta*v - x\n"
         "y1' = growth*y1 + omega*y2\ny2' = growth*y2 - omega*y1\nevent wall = u - x\nevent maximum = v\n"
         "jump impact: v -> -r*v\nafter any: wall -> impact, maximum -> identity\n";
}

const char* const ball =
    "par g=9.81, r=0.8\ninit x=1e-6, v=0, p=1e5\nx' = v\nv' = -g\np' = 0\n"
    "event floor = x\njump impact: v -> -r*v\nafter any: floor -> impact\n";

}  // namespace

TEST_CASE("an oscillator in metres, millimetres or nanometres has its period doubling, and unstable orbits are so") {
  const std::string u = GENERATE("1", "1e-3", "1e-6", "1e-9", "1e6");
  INFO("u = " << u);
  const Workspace workspace;
  workspace.write("osc.tch", oscillator(u));
  workspace.succeed("simulate osc --dat s -q");
  const Outcome outcome = workspace.succeed(std::vector<std::string>{
      "run", "osc", "-c", "s", "-d", "s", "-o", "b", "DS=-0.02", "RL0=3.0358", "UZR={alpha:[3.0361,3.036]}"});
  INFO(outcome.text());
  CHECK_FALSE(contains(outcome.text(), "tangent"));
  CHECK(contains(outcome.out, "normal form c = "));
  CHECK(contains(outcome.out, "PD label 2 at alpha = 3.036193566"));
  std::vector<double> unstable;
  for (const PointRow& row : workspace.points("b").front().rows) {
    if (std::abs(row.type) == 4 && row.point > 0) unstable.push_back(row.values[0]);
  }
  // The multipliers of the closed form at the two labels are -1.6084192 and -2.3369872.
  REQUIRE(unstable.size() == 2);
  CHECK(contains(workspace.succeed("verify q.b -p osc").out, "5 labels agree with forward integration"));
}

TEST_CASE(
    "the first Lyapunov coefficient does not depend on the unit of time, nor on rounding of a speed that is zero") {
  const Workspace workspace;
  for (const std::string T : {"1", "1.46e-3", "1.46e-7", "3e5"}) {
    INFO("T = " << T);
    workspace.write("valve.tch", "par q=10\nnumber T=" + T +
                                     "\ninit lift=5, pressure=15\nlift' = T*speed\n"
                                     "speed' = T*(pressure - (lift + 10) - 1.25*speed)\n"
                                     "pressure' = T*20*(q - lift*sqrt(pressure))\n");
    const double wait = 1000.0 / std::stod(T);
    workspace.succeed(
        std::vector<std::string>{"simulate", "valve", "--dat", "rest", "-q", "--wait", std::to_string(wait)});
    const std::string out = workspace.succeed("run valve -c rest -d rest -o rest DS=-0.1 RL0=1 RL1=20").out;
    INFO(out);
    // By Kuznetsov's formula with the Jacobian's eigenvectors, in another program.
    CHECK(out.find("l_1 = -0.000231355167") != std::string::npos);
  }
}

TEST_CASE("a ball falls on a floor, whatever the pressure that nothing depends on, and however near the floor is") {
  const Workspace workspace;
  workspace.write("gap.tch", ball);
  for (const std::string state : {"p=1e5", "p=0", "p=1e-9"}) {
    INFO(state);
    const Outcome outcome = workspace.succeed(
        std::vector<std::string>{"simulate", "gap", "--state", state, "--time", "0.003", "-o", "fall"});
    // Impacts at t = T (1 + 2 (r + r^2 + ...)), T = sqrt(2 x / g): six until 0.003.
    CHECK(contains(outcome.out, "6 events"));
    std::vector<double> times;
    for (const ListedEvent& event : read_event_list(workspace.read("fall.events"), 3)) times.push_back(event.time);
    REQUIRE(times.size() >= 6);
    const double first = std::sqrt(2e-6 / 9.81);
    double expected = first;
    for (int k = 0; k < 6; ++k) {
      CHECK(times[static_cast<std::size_t>(k)] == Approx(expected).epsilon(1e-8));
      expected += 2.0 * first * std::pow(0.8, k + 1);
    }
  }
  const Outcome near =
      workspace.succeed(std::vector<std::string>{"simulate", "gap", "--state", "x=5e-10,p=0", "--time", "3e-4"});
  // The limit of all impacts is T (1 + r) / (1 - r).
  CHECK(contains(near.out, "t = 9.0867379"));
}

TEST_CASE("a clock beside a state of 2e9 ticks, and the orbit is found") {
  const Workspace workspace;
  workspace.write("clock.tch",
                  "par k=1\ninit tau=0, u=2e9\ntau' = 1\nu' = -0.01*k*(u - 2e9)\n"
                  "event tick = 1 - tau\njump apply: tau -> 0\nafter any: tick -> apply\n");
  const Outcome outcome = workspace.succeed("simulate clock");
  INFO(outcome.text());
  CHECK(contains(outcome.out, "Periodic orbit, signature {(1,1,1)}, period 1\n"));
}

TEST_CASE("a valve in metres has the impact of a tenth of a millimetre a second that it has in millimetres") {
  // A spool between two stops with Coulomb friction, pressed by an oscillating pressure; times by closed forms of each
  // phase.
  const Workspace workspace;
  workspace.write("valve.tch", R"(par freq=250, amp=27580, mean=124110, M=0.0003361185937456267, k=1488.578099595049
par preload=8.54503372291542, area=7.373657906574696e-5, fr=1, r=0.3, width=0.001016
init x=0.0004, v=0.1, c=1
om = 2*pi*freq
net = (mean + amp*s)*area - preload - k*x
x' = v
s' = om*((1 - s^2 - c^2)*s + c)
c' = om*((1 - s^2 - c^2)*c - s)
field right: v' = (net - fr)/M
field left:  v' = (net + fr)/M
event slows = v
event turns = -v
event rstop = width - x
event lstop = x
jump bounce: v -> -r*v
slide stuck on slows: go_left -> left, go_right -> right
after any if stuck:  stuck until go_left -> identity, go_right -> identity
after rstop: left until turns -> identity, lstop -> bounce
after lstop: right until slows -> identity, rstop -> bounce
after any if right:  right until slows -> identity, rstop -> bounce
after any:           left until turns -> identity, lstop -> bounce
)");
  const Outcome outcome = workspace.succeed("simulate valve");
  INFO(outcome.text());
  CHECK(contains(outcome.out,
                 "(1,1,2), (2,4,1), (1,1,2), (2,4,1), (1,1,2), (2,4,1), (1,1,2), (3,6,2), (1,3,1), "
                 "(2,2,2), (1,1,2), (3,5,2), (2,4,1)"));
  CHECK(contains(outcome.out, "h_x f = -0.00011325"));
}

TEST_CASE(
    "a torus is one in seconds and pascals, and beside a state that is zero, and verify compares its multipliers") {
  // Two coupled van der Pol oscillators, one in units of Y, in time T. The rotation number on the section x' = 0 by
  // direct integration (scipy, relative tolerance 1e-11): 0.3466135079.
  struct Units {
    const char* Y;
    const char* T;
    const char* first_line;
  };
  for (const auto& [Y, T, first_line] : {Units{"1.5e5", "1e-6", ""}, Units{"1", "1", "zero' = -zero\n"}}) {
    INFO("Y = " << Y << ", T = " << T << ", " << first_line);
    const Workspace workspace;
    workspace.write("pair.tch", "par e=0.5, k=0.2, d=0.9\nnumber Y=" + std::string(Y) + ", T=" + T +
                                    "\ninit x=2, y=" + Y + "\n" + first_line +
                                    "x' = u/T\nu' = (e*(1 - x^2)*u - x + k*(y/Y - x))/T\ny' = w/T\n"
                                    "w' = (e*(1 - (y/Y)^2)*w - (1 + d)*y + k*(x*Y - y))/T\n"
                                    "event section = u\njump same: x -> x\nafter any: section -> same\n");
    const std::string found =
        workspace.succeed("simulate pair --signature 1,1,1 --torus t --transient-events 100 --events 400").out;
    INFO(found);
    CHECK(contains(found, "Rotation number rho = 0.3466135"));
    workspace.succeed("run pair -c t -s t -o b ICP=[k,rho] NMX=2 DS=0.02 -q");
    const std::string verified = workspace.succeed("verify q.b -p pair").out;
    INFO(verified);
    CHECK(contains(verified, "multipliers "));
    CHECK_FALSE(contains(verified, "no multipliers"));
  }
}

TEST_CASE("a run whose steps are too short to go anywhere says so, and how long they would have to be") {
  const Workspace workspace;
  workspace.write("rest.tch", "par force=4e12\ninit x=1\nx' = force/4e12 - x\n");
  workspace.succeed("simulate rest --dat s -q");
  const std::string short_steps = workspace.succeed("run rest -c s -d s -o a NMX=30 DS=0.1").out;
  INFO(short_steps);
  CHECK(contains(short_steps, "29 of them of length DSMAX = 0.1, nothing has changed by more than"));
  CHECK(contains(short_steps, "for example DSMAX=8e+10"));
  const std::string longer = workspace.succeed("run rest -c s -d s -o b NMX=30 DS=8e10 DSMAX=8e10").out;
  CHECK(workspace.points("b").front().rows.back().values[0] > 5e12);
  CHECK_FALSE(contains(longer, "nothing has changed"));
}

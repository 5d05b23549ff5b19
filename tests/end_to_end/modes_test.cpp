// Modes of dimension 5, 3 and 2: flight of a ball beside a pendulum, a spring with a force that lags, rest with a
// clock. The references are integrations of each mode with the states that it has.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "end_to_end/integrate_to.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* modes_source = R"(#include <tchat/problem.hpp>

struct Modes {
  static constexpr int dimension = 5, parameters = 3;
  static constexpr int fields = 3, events = 4, jumps = 4;
  static constexpr const char* state_names[] = {"x", "v", "lag", "theta", "rate"};
  static constexpr const char* parameter_names[] = {"k", "d", "V"};
  static constexpr const char* field_names[] = {"flight", "spring", "rest"};
  static constexpr const char* event_names[] = {"floor", "lowest", "alarm", "top"};
  static constexpr const char* jump_names[] = {"catch", "stop", "throw", "cut"};
  static constexpr double initial_parameters[] = {10.0, 0.3, 1.0};
  static constexpr double initial_state[] = {0.0, 1.0, 0.0, 0.0, 0.5};
  static constexpr int dimension_of(int i) { return i == 1 ? 5 : i == 2 ? 3 : 2; }
  static constexpr int dimension_after(int k) { return k == 1 ? 3 : k == 2 ? 2 : 5; }

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    if (i == 1)
      f[0] = x[1], f[1] = T(-1.0), f[2] = x[0] - x[2], f[3] = x[4], f[4] = -par[1] * x[4] - sin(x[3]);
    else if (i == 2)
      f[0] = x[1], f[1] = -1.0 - par[0] * x[0] - par[1] * x[2], f[2] = 3.0 * (x[1] - x[2]);
    else
      f[0] = -0.2 * x[0], f[1] = T(1.0);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : j == 2 ? T(-x[1]) : j == 3 ? T(0.7 - x[1]) : x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    if (k == 1) g[0] = x[0], g[1] = x[1], g[2] = x[2] + 0.1 * x[4];
    if (k == 2) g[0] = x[0], g[1] = 0.1 * x[2];
    if (k == 3) g[0] = T(0.0), g[1] = par[2] - 0.5 * x[0], g[2] = 0.2 * x[0], g[3] = 0.1 * x[0], g[4] = T(0.5);
    if (k == 4) for (int a = 0; a < 5; ++a) g[a] = x[a];
  }
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[2] == 1) return {{2, 2, 2}};
    if (from[2] == 2) return {{3, 3, 3}};
    return {{1, 1, 1}};
  }
};
TCHAT_PROBLEM(Modes)
)";

constexpr const char* formulas = R"(par k=10, d=0.3, V=1
init x=0, v=1, rate=0.5
field flight: x' = v, v' = -1, lag' = x - lag, theta' = rate, rate' = -d*rate - sin(theta)
mode spring: states x, v, lag
field spring: x' = v, v' = -1 - k*x - d*lag, lag' = 3*(v - lag)
mode rest: states x, v
field rest: x' = -0.2*x, v' = 1
event floor = x
event lowest = -v
event alarm = 0.7 - v
event top = v
jump catch to spring: lag -> lag + 0.1*rate
jump stop to rest: v -> 0.1*lag
jump throw: x -> 0, v -> V - 0.5*x, lag -> 0.2*x, theta -> 0.1*x, rate -> 0.5
jump cut:
after catch: spring until lowest -> stop
after stop: rest until alarm -> throw
after any: flight until floor -> catch
)";

/// Durations and the end of one turn from a start of flight (5 states), each mode with its own states.
struct Turn {
  std::array<double, 3> durations;
  std::array<double, 5> end;
};
Turn turn(std::array<double, 5> x, double k, double d, double V) {
  Turn result{};
  result.durations[0] = integrate_to(
      x,
      [&](const auto& u, auto& f, double) {
        f = {u[1], -1.0, u[0] - u[2], u[4], -d * u[4] - std::sin(u[3])};
      },
      [](const auto& u) { return u[0]; });
  std::array<double, 3> y{x[0], x[1], x[2] + 0.1 * x[4]};
  result.durations[1] = integrate_to(
      y,
      [&](const auto& u, auto& f, double) {
        f = {u[1], -1.0 - k * u[0] - d * u[2], 3.0 * (u[1] - u[2])};
      },
      [](const auto& u) { return -u[1]; });
  std::array<double, 2> z{y[0], 0.1 * y[2]};
  result.durations[2] = integrate_to(
      z,
      [](const auto& u, auto& f, double) {
        f = {-0.2 * u[0], 1.0};
      },
      [](const auto& u) { return 0.7 - u[1]; });
  result.end = {0.0, V - 0.5 * z[0], 0.2 * z[0], 0.1 * z[0], 0.5};
  return result;
}

}  // namespace

TEST_CASE("modes of dimension 5, 3 and 2 in every command") {
  const Workspace workspace;
  SECTION("a class") { workspace.write("modes.cpp", modes_source); }
  SECTION("formulas") { workspace.write("modes.tch", formulas); }
  workspace.succeed("check modes");
  const Outcome simulated = workspace.succeed("simulate modes --dat start");
  CHECK(simulated.out.find("{(1,1,1), (2,2,2), (3,3,3)}") != std::string::npos);
  workspace.succeed("run modes -q -c start -d start -o branch NTST=20 ICP=[V] NMX=40 DS=0.02 DSMAX=0.1 UZR={V:1.3}");
  for (const SolutionEntry& label : workspace.solutions("branch")) {
    std::array<double, 5> start{};
    for (std::size_t a = 0; a < 5; ++a) start[a] = label.states.front().at(a);
    const Turn at = turn(start, label.parameter(1), label.parameter(2), label.parameter(3));
    // Newton ends at 1e-10, the mesh's error is 1e-9.
    for (int s = 0; s < 3; ++s)
      CHECK(label.parameter(61 + s) == Approx(at.durations[static_cast<std::size_t>(s)]).epsilon(1e-8));
    for (std::size_t a = 0; a < 5; ++a) CHECK(at.end[a] == Approx(start[a]).margin(1e-8));
    // What a mode has not is zero.
    for (const auto& row : label.states)
      for (const std::size_t absent : {8U, 9U, 12U, 13U, 14U}) CHECK(row.at(absent) == 0.0);
  }
  const std::string diagnostics = workspace.read("d.branch");
  CHECK(diagnostics.find("Multiplier   2") != std::string::npos);
  CHECK(diagnostics.find("Multiplier   3") == std::string::npos);
  workspace.succeed("verify branch -p modes");
  workspace.succeed("resegment q.branch UZ1 -p modes --to rotate --by 1 -o cut");
  workspace.succeed("run modes -q -c cut -s cut -o again NMX=4");
  workspace.succeed("verify again -p modes");
  workspace.succeed("sweep modes -q --over V=1:1.2:3 -o values");
  workspace.succeed("simulate modes -q --lyapunov");
  workspace.succeed("orbit q.branch UZ1");
  workspace.succeed("labels branch");
  workspace.succeed("table branch");
}

TEST_CASE("an orbit and an equilibrium of the small mode alone") {
  const Workspace workspace;
  workspace.write("small.tch", R"(par a=-0.1
field large: x' = 1, y' = 0, z' = x
mode circle: states x, y
field circle: x' = a*x - y - x*(x^2+y^2), y' = x + a*y - y*(x^2+y^2)
event cut = y
jump away: z -> 1
)");
  workspace.write("gc.small",
                  "NDIM=3 IPS=1 ICP=[a] NMX=30 RL1=0.5 DS=0.02 DSMAX=0.05\nGCFIND=[2] GCHIND=[0] GCGIND=[0]\n");
  workspace.write("small.dat", "0 0 0 0\n");
  workspace.succeed("run small -q -o rest");
  CHECK(workspace.read("d.rest").find("Eigenvalue   3") == std::string::npos);
  workspace.succeed("run small -q -s rest IRS=HB1 IPS=180 ISW=-1 UZR={-a:0.25} RL1=0.4 -o cycles");
  // The circle of radius sqrt(a), once round in 2 pi, with the multiplier exp(-4 pi a).
  const SolutionEntry label = workspace.solutions("cycles").back();
  CHECK(label.parameter(1) == Approx(0.25).epsilon(1e-9));
  CHECK(std::hypot(label.states.front().at(0), label.states.front().at(1)) == Approx(0.5).epsilon(1e-7));
  CHECK(label.parameter(61) == Approx(2.0 * std::acos(-1.0)).epsilon(1e-8));
  CHECK(workspace.read("d.cycles").find("Multiplier   3") == std::string::npos);
  workspace.succeed("verify cycles -p small");
}

TEST_CASE("a start in a mode has its states only") {
  const Workspace workspace;
  workspace.write("modes.tch", formulas);
  const Outcome outcome = workspace.succeed("simulate modes --state x=-0.1,v=-0.2,theta=3 --mode 2,2,2 --events 1");
  CHECK(outcome.out.find("Start: x = (-0.1, -0.2, 0, 0, 0)") != std::string::npos);
}

TEST_CASE("tori of a system with modes of 5 and 3 states, from their birth on") {
  // Langford's system (problems/langford) with two states more where y > 0. By its symmetry in closed form: the orbit
  // of period 2 pi / d, its torus bifurcation at a = b^2 (1 + e b) + e (c - b^3/3), and that angle of its multipliers.
  constexpr double c = 0.6, d = 3.5, e = 0.25;
  const auto critical = [](double b) { return b * b * (1.0 + e * b) + e * (c - b * b * b / 3.0); };
  const auto angle = [](double b, double a) {
    return 2.0 * M_PI * std::sqrt(2.0 * (c + a * b - b * b * b / 3.0)) / d;  // 2 r^2 (1 + e b)
  };
  const Workspace workspace;
  workspace.write("langford.tch", R"(par a=0.5, b=0.7, c=0.6, d=3.5, e=0.25
init x=0.9, y=0.01, z=0.7
field upper: x' = (z-b)*x - d*y, y' = d*x + (z-b)*y, z' = c + a*z - z^3/3 - (x^2+y^2)*(1+e*z), \
             lag' = x - lag, load' = lag*z - load
mode lower: states x, y, z
field lower: x' = (z-b)*x - d*y, y' = d*x + (z-b)*y, z' = c + a*z - z^3/3 - (x^2+y^2)*(1+e*z)
event fall = y
event rise = -y
jump down to lower:
jump up: lag -> 0.1*x, load -> z
after down: lower until rise -> up
after any: upper until fall -> down
)");
  workspace.succeed("simulate langford -q --dat start");
  workspace.succeed("run langford -q -c start -d start -o orbit ICP=[a] DS=0.02 NMX=40 RL1=0.8 NTST=20");
  const SolutionEntry birth = workspace.solutions("orbit").at(1);
  CHECK(birth.type == 8);  // TR
  CHECK(birth.parameter(1) == Approx(critical(0.7)).epsilon(1e-9));
  workspace.succeed("run langford -q -c r.orbit -s orbit -o curve IRS=TR1 ISW=2 ICP=[b,a] NMX=10 RL1=2").out;
  for (const PointSection& section : workspace.points("curve"))
    for (const PointRow& row : section.rows) {
      const double b = row.values[section.column("b")];
      CHECK(row.values[section.column("a")] == Approx(critical(b)).epsilon(1e-8));
    }
  workspace.succeed("run langford -q -c r.orbit -s orbit -o born IRS=TR1 IPS=182 ISW=-1 ICP=[a,rho] DS=0.05 NMX=8");
  const PointSection born = workspace.points("born").front();
  const double turn = angle(0.7, critical(0.7)) / (2.0 * M_PI);
  CHECK(born.rows.front().values[born.column("rho")] == Approx(turn).epsilon(1e-3));
  // The return time of the orbit stays that of the torus.
  const SolutionEntry last = workspace.solutions("born").back();
  CHECK(last.parameter(61) + last.parameter(62) == Approx(2.0 * M_PI / d).epsilon(1e-9));
  const std::string diagnostics = workspace.read("d.born");
  CHECK(diagnostics.find("Multiplier   3") != std::string::npos);
  CHECK(diagnostics.find("Multiplier   4") == std::string::npos);
  CHECK(workspace.succeed("verify born -p langford").out.find("multipliers 0.0e+00") == std::string::npos);
  const Outcome refused = workspace.tchat("sweep langford --map q.born:EP1 --over a=0.7:0.72:2 --wall 1");
  CHECK(refused.status == 2);
  CHECK(refused.err.find("its returns have the fields 1 (upper) and 2 (lower)") != std::string::npos);
}

TEST_CASE("modes that cannot follow each other, and lines that are no modes") {
  const Workspace workspace;
  const auto refused = [&](const std::string& arguments, const std::string& words) {
    const Outcome outcome = workspace.tchat(arguments);
    INFO(arguments << '\n' << outcome.text());
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find(words) != std::string::npos);
  };
  workspace.write("modes.tch", formulas);
  workspace.write("modes.dat", "# PAR(61) = 1\n# PAR(62) = 1\n0 0 0 0 0 0 0 0 0 0 0\n1 0 0 0 0 0 0 0 0 0 0\n");
  workspace.write("gc.modes", "NDIM=5 ICP=[V]\nGCFIND=[1,3]\nGCHIND=[1,3]\nGCGIND=[0,3]\n");
  refused("run modes", "the identity cannot lead from field 1 (flight) with 5 states to field 3 (rest) with 2");
  refused("run modes GCGIND=[1,3]", "jump 1 (catch) sets 3 states, and field 3 (rest) after it has 2");
  const std::string start = "field large: x' = y, y' = z, z' = x\nevent cut = y\n";
  const std::vector<std::pair<std::string, std::string>> mistakes = {
      {"mode low: states y, x\nfield low: x' = 1, y' = 0\n", "the states of a mode are the first ones of all"},
      {"mode low: states x, y\nfield low: x' = 1, y' = z\n", "the equation for y needs z, which the mode low has not"},
      {"mode low: states x, y\nfield low: x' = 1, y' = 0, z' = 1\n", "z is no state of the mode low"},
      {"mode low: states x, y\nfield low: x' = 1, y' = 0\njump down to low: z -> 1\n", "z is no state of the mode low"},
      {"mode low: states x, y\nmode low: states x\nfield low: x' = 1, y' = 0\n", "there are two lines 'mode low'"},
      {"mode lower: states x, y\nfield low: x' = 1, y' = 0, z' = 0\n", "there is no field 'lower'"},
      {"mode low states x, y\nfield low: x' = 1, y' = 0\n", "it is written 'mode FIELD: states a, b, c'"}};
  for (const auto& [lines, words] : mistakes) {
    workspace.write("wrong.tch", start + lines);
    refused("check wrong", words);
  }
}

TEST_CASE("energy is checked with the states that a mode has") {
  const Workspace workspace;
  workspace.write("hopper.tch", R"(init x=0.5
field stance: x' = v, v' = -x, s' = v*(1 - s^2)
mode flight: states x, v
field flight: x' = v, v' = -1
event ground = x
event leave = -x
jump land: s -> 0
jump lift to flight: v -> v
aux energy = v^2/2 + x + 7*s
)");
  workspace.write("gc.hopper", "NDIM=3 CONSERVED=energy ICP=[energy]\nGCFIND=[2] GCHIND=[1] GCGIND=[2]\n");
  const Outcome outcome = workspace.succeed("check hopper");
  CHECK(outcome.out.find("conserved by field 2 (flight)") != std::string::npos);
}

TEST_CASE("derivatives by hand of a small mode") {
  const Workspace workspace;
  std::string source = modes_source;
  const std::string member =
      R"(  void field_derivatives(int i, const double* x, const double* par, double* dx, double* dp) const {
    if (i == 1) dx[0 + 5 * 1] = 1, dx[2 + 5 * 0] = 1, dx[2 + 5 * 2] = -1, dx[3 + 5 * 4] = 1, dx[4 + 5 * 3] = -cos(x[3]),
        dx[4 + 5 * 4] = -par[1], dp[4 + 5 * 1] = -x[4];
    if (i == 2) dx[0 + 5 * 1] = 1, dx[1 + 5 * 0] = -par[0], dx[1 + 5 * 2] = -par[1], dx[2 + 5 * 1] = 3, dx[2 + 5 * 2] = -3,
        dp[1 + 5 * 0] = -x[0], dp[1 + 5 * 1] = -x[2];
    if (i == 3) dx[0 + 5 * 0] = -0.2;
  }
)";
  source.insert(source.find("  template <class T>\n  T event"), member);
  workspace.write("modes.cpp", source);
  workspace.succeed("check modes");
}

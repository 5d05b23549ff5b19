// tchat resegment where an orbit touches once in several periods, and where it touches at several places at once.
#include <fmt/format.h>

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/closed_forms.hpp"

using namespace test_support;

namespace {

constexpr double zeta = 0.05, restitution = 0.8;

/// A forced oscillator between walls at +1 and -1, symmetric; events: the walls, maximum and minimum of x.
const char* const between_walls = R"(#include <tchat/problem.hpp>

struct BetweenWalls {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 4, jumps = 2;
  static constexpr const char* parameter_names[] = {"alpha", "omega"};
  static constexpr const char* event_names[] = {"right wall", "left wall", "maximum", "minimum"};
  static constexpr double initial_parameters[] = {2.9, 2.0};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = par[0] * x[3] - 0.1 * x[1] - x[0];
    f[2] = growth * x[2] + par[1] * x[3];
    f[3] = growth * x[3] - par[1] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? T(1.0 - x[0]) : j == 2 ? T(1.0 + x[0]) : j == 3 ? x[1] : T(-x[1]);
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -0.8 * x[1];
  }
};
TCHAT_PROBLEM(BetweenWalls)
)";

const char* const between_walls_constants = R"(NDIM = 4, IPS = 180, IRS = 0, ICP = [1, 61], NTST = 30, NMX = 30
RL1 = 3.5, DS = 0.02, DSMAX = 0.2, EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-10
GCFIND = [1], GCHIND = [3], GCGIND = [2], GCSEGTYP = [0], GCHGRZIND = [[1, 2]], GCIPSI = [1, 2]
)";

/// alpha of the symmetric orbit that hits both walls with velocity v: half a period T/2 and the impact turn the free
/// oscillation (u, u') into its negative, (E(T/2) + Id) (u, u') = (0, -(1 + r) v).
double alpha_between_walls(double v, double omega) {
  const double half = M_PI / omega, frequency = std::sqrt(1.0 - zeta * zeta);
  const double c = std::cos(frequency * half), s = std::sin(frequency * half) / frequency;
  Eigen::Matrix2d flow;
  flow << c + zeta * s, s, -s, c - zeta * s;
  const Eigen::Matrix2d closing = std::exp(-zeta * half) * flow + Eigen::Matrix2d::Identity();
  const Eigen::Vector2d free = closing.partialPivLu().solve(Eigen::Vector2d(0.0, -(1.0 + restitution) * v));
  const double position = 1.0 - free(0), velocity = -restitution * v - free(1);  // of the forced oscillation
  return std::hypot(position, velocity / omega) / amplitude(1.0, omega, zeta);
}

void enter_between_walls(const Workspace& workspace) {
  const double omega = 2.0;
  const NonimpactingOrbit orbit(2.9, omega, zeta);
  std::string data;
  for (int k = 0; k <= 60; ++k) {
    const double t = orbit.period() * k / 60;
    data += fmt::format("{:.15g}", t);
    for (const double x : orbit.at(t)) data += fmt::format(" {:.15g}", x);
    data += '\n';
  }
  workspace.write("walls.cpp", between_walls);
  workspace.write("walls.dat", data);
  workspace.write("gc.walls", between_walls_constants);
  workspace.succeed("run walls -o grazing");
}

}  // namespace

TEST_CASE("resegment: orbits with one impact in n periods, from a grazing point and from a grazing curve") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  workspace.run("-c grazing_curve -s grazing -o curve NMX=20");
  for (const std::string& label : {std::string("grazing GR1"), std::string("curve UZ1")})
    for (const int n : {2, 3, 5}) {
      CAPTURE(label, n);
      const Outcome made =
          workspace.succeed(fmt::format("resegment q.{} --to impacting --repeat {} -o born -p linosc "
                                        "ICP=[1] NMX=8 NPR=1 RL0=0 RL1=10 DSMAX=0.1 GRSTOP=0",
                                        label, n));
      CHECK(contains(made.out, "{(1,1,1), (1,2,2)"));
      workspace.run("-c born -s born -o born1");
      const auto solutions = workspace.solutions("born1");
      REQUIRE(solutions.size() > 3);
      for (const SolutionEntry& solution : solutions) {
        const double v = solution.states.back()[1], omega = solution.parameter(2);
        CAPTURE(v);
        CHECK(v > 0.0);  // DS leads to impacts
        REQUIRE(solution.states.back().size() == 4U * static_cast<std::size_t>(n));
        const ImpactingOrbit exact(v, omega, zeta, restitution, n);
        CHECK(std::abs(solution.parameter(1) - exact.alpha()) < 1e-7);
        double period = 0.0;
        for (int s = 0; s < n; ++s) period += solution.parameter(61 + s);
        CHECK(std::abs(period - exact.period()) < 1e-7);
        const State impact = exact.at(exact.period());  // the end of segment 1
        for (const std::size_t k : {0U, 1U, 2U, 3U}) CHECK(std::abs(solution.states.back()[k] - impact[k]) < 1e-7);
      }
    }
  check_refused(workspace.tchat("resegment q.curve UZ1 --to rotate --repeat 2 -o none -p linosc"), {"--to impacting"});
  check_refused(workspace.tchat("resegment q.curve UZ1 --to impacting --repeat 65 -o none -p linosc"), {"--repeat"});
}

TEST_CASE("grazing: an orbit that touches two walls at once is refused") {
  const Workspace workspace;
  enter_between_walls(workspace);
  check_refused(workspace.tchat("grazing q.grazing GR1 -p walls"),
                {"in contact at 2 places at once", "event 1 (right wall)", "event 2 (left wall)"});
}

TEST_CASE("resegment: an orbit that touches two walls at once hits both") {
  const Workspace workspace;
  enter_between_walls(workspace);
  const double at_grazing = 1.0 / amplitude(1.0, 2.0, zeta);
  CHECK(std::abs(workspace.solutions("grazing").back().parameter(1) - at_grazing) < 1e-8);

  workspace.succeed("resegment q.grazing GR1 --to grazing-curve -o curve -p walls ICP=[1,2,61] NMX=4 NPR=1");
  workspace.succeed("run walls -c curve -s curve -o curve1");
  for (const std::string& label : {std::string("grazing GR1"), std::string("curve1 EP1")}) {
    CAPTURE(label);
    const Outcome made = workspace.succeed("resegment q." + label +
                                           " --to impacting -o born -p walls ICP=[1] NMX=8 NPR=1 DSMAX=0.1 RL1=10");
    CHECK(contains(made.out, "2 contacts at once"));
    CHECK(contains(made.out, "leads to the side with the new event"));
    workspace.succeed("run walls -c born -s born -o born1");
    CHECK_FALSE(contains(workspace.read("d.born1"), "Inadmissible"));
    const auto solutions = workspace.solutions("born1");
    REQUIRE(solutions.size() > 3);
    for (const SolutionEntry& solution : solutions) {
      const auto& end = solution.states.back();
      REQUIRE(end.size() == 8);
      const double v = std::abs(end[1]);
      CAPTURE(v);
      CHECK(v > 1e-3);
      CHECK(std::abs(end[1] + end[5]) < 1e-7);  // the same velocity at both walls
      CHECK(std::abs(end[0] + end[4]) < 1e-9);
      CHECK(std::abs(solution.parameter(1) - alpha_between_walls(v, solution.parameter(2))) < 1e-7);
    }
  }

  // Back to where both velocities vanish: one contact is kept, the other impact becomes a section.
  workspace.succeed("run walls -c born -s born1 -o back IRS=EP1 --both NMX=60 NPR=0");
  const Outcome again = workspace.succeed("resegment q.back GR1 --to grazing-curve -o again -p walls ICP=[1,2] NMX=3");
  CHECK(contains(again.out, "2 contacts at once"));
  workspace.succeed("run walls -c again -s again -o again1");
  const SolutionEntry end = workspace.solutions("again1").back();
  CHECK(std::abs(end.parameter(1) * amplitude(1.0, end.parameter(2), zeta) - 1.0) < 1e-7);
}

TEST_CASE("resegment: where stick leaves a state undetermined the contact ends in a jump that sets it") {
  const Workspace workspace;
  std::filesystem::copy_file(MEMS_SOURCE, workspace.file("mems.cpp"));
  std::filesystem::copy_file(MEMS_CONSTANTS "/gc.nonimpacting", workspace.file("gc.nonimpacting"));
  workspace.succeed("simulate mems PAR(V)=0.3 --dat orbit -o motion -q");
  workspace.succeed("run mems -c nonimpacting -d orbit -o touching");
  workspace.succeed("resegment q.touching GR1 --to impacting -o born -p mems NMX=6");
  workspace.succeed("run mems -c born -s born -o born1");
  workspace.succeed("run mems -c born -s born1 -o back IRS=EP1 NMX=30 --both");
  // The impact's velocity vanishes; in stick nothing but a jump determines the frame's velocity.
  const Outcome made = workspace.succeed("resegment q.back GR1 --to grazing-curve -o curve -p mems ICP=[2,1] NMX=2");
  CHECK(contains(made.out, "{(1,1,3)}, IPS = 150"));
  CHECK(contains(made.out, "ends in jump 3 (stick)"));
  workspace.succeed("run mems -c curve -s curve -o curve1");
  const PointSection section = workspace.points("curve1").front();
  CHECK(std::abs(section.rows.front().values[section.column("V")] - 0.597984349382) < 1e-8);  // at omega = 0.8
  const Outcome own = workspace.succeed("resegment q.back GR1 --to grazing-curve --jump 2 -o own -p mems ICP=[2,1]");
  CHECK(contains(own.out, "{(1,1,2)}"));
  CHECK(workspace.tchat("run mems -c own -s own -o own1").status == 1);  // singular, and told
}

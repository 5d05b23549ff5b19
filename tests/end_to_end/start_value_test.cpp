// A branch begins at the parameter values asked for, or is refused: a ball that bounces on a vibrating table, once in
// every period. In units of the acceleration of gravity and the frequency its impacts are at the phase
// cos(phi) = pi (1 - r) / ((1 + r) Gamma), so that there is no orbit for Gamma < pi (1 - r) / (1 + r).
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

const std::string ball = R"(#include <tchat/problem.hpp>
struct Ball {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 1, jumps = 1;
  static constexpr const char* state_names[] = {"gap", "velocity", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"Gamma", "r"};
  static constexpr double initial_parameters[] = {0.8, 0.7};
  static constexpr double initial_state[] = {0.0, 2.587, 0.721, 0.693};
  template <class T> void field(int, const T* x, const T* p, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1], f[1] = p[0] * x[2] - 1.0;
    f[2] = growth * x[2] + x[3], f[3] = growth * x[3] - x[2];
  }
  template <class T> T event(int, const T* x, const T*) const { return x[0]; }
  template <class T> void jump(int, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    g[1] = -p[1] * x[1];
  }
};
TCHAT_PROBLEM(Ball)
)";

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

double impact_cosine(double gamma, double r) { return pi * (1.0 - r) / ((1.0 + r) * gamma); }

}  // namespace

TEST_CASE("a start at parameter values without an orbit is refused, with both values") {
  const Workspace workspace;
  workspace.write("ball.cpp", ball);
  const Outcome simulated = workspace.tchat("simulate ball --dat found");
  INFO(simulated.text());
  REQUIRE(simulated.status == 0);
  const std::string run = "run ball -c found -d found -o branch NMX=3 ";

  for (const char* beyond : {"PAR(Gamma)=0.1", "PAR(r)=0.3"}) {
    INFO(beyond);
    const Outcome refused = workspace.tchat(run + beyond);
    INFO(refused.text());
    CHECK(refused.status == 1);
    CHECK(contains(refused.err, contains(beyond, "Gamma") ? "Gamma = 0.1" : "r = 0.3"));
    CHECK(contains(refused.err, "no further"));
    CHECK_FALSE(workspace.has("p.branch"));
  }
  const Outcome moved = workspace.tchat(run + "PAR(Gamma)=0.55 ICPMOVE=1");
  INFO(moved.text());
  REQUIRE(moved.status == 0);
  CHECK(contains(moved.err, "the first point has Gamma = "));
  CHECK(workspace.points("branch").front().rows.front().values.front() >= impact_cosine(1.0, 0.7) - 1e-9);
}

TEST_CASE("a start from which Newton's method comes to the equilibrium is refused, and so named") {
  const Workspace workspace;
  // r' = r (mu - r^2): the cycle r = sqrt(mu) for mu > 0, the equilibrium 0 for all mu and any duration.
  workspace.write("hopf.cpp", R"(#include <tchat/problem.hpp>
struct Hopf {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T> void field(int, const T* x, const T* p, T* f) const {
    const T growth = p[0] - x[0] * x[0] - x[1] * x[1];
    f[0] = growth * x[0] - x[1], f[1] = growth * x[1] + x[0];
  }
  template <class T> T event(int, const T* x, const T*) const { return x[1]; }
  template <class T> void jump(int, const T* x, const T*, T* g) const { g[0] = x[0], g[1] = x[1]; }
};
TCHAT_PROBLEM(Hopf)
)");
  workspace.write("gc.hopf", "NDIM = 2\nIPS = 180\nICP = [1, 61]\nNTST = 20\nNMX = 2\nDS = 0.001\n");
  const auto start = [&](double mu, double radius) {
    std::string text = "# PAR(1) = " + std::to_string(mu) + "\n";
    for (int k = 0; k <= 100; ++k) {
      const double angle = pi * k / 50.0;
      text += std::to_string(angle) + " " + std::to_string(-radius * std::cos(angle)) + " " +
              std::to_string(-radius * std::sin(angle)) + "\n";
    }
    workspace.write("hopf.dat", text);
    return workspace.tchat("run hopf -o branch");
  };
  for (const double mu : {-1.0, -0.3, -0.001, 0.2})
    for (const double radius : {0.003, 0.03}) {
      const Outcome refused = start(mu, radius);
      INFO(mu << ", " << radius << "\n" << refused.text());
      CHECK(refused.status == 1);
      CHECK(contains(refused.err, "an equilibrium, no orbit"));
      CHECK_FALSE(workspace.has("p.branch"));
    }
  REQUIRE(start(0.2, 0.4).status == 0);
  CHECK(workspace.points("branch").front().rows.front().values.back() == Approx(2.0 * pi).epsilon(1e-7));
}

TEST_CASE("a start at other parameter values is followed to them") {
  const Workspace workspace;
  workspace.write("ball.cpp", ball);
  REQUIRE(workspace.tchat("simulate ball --dat found").status == 0);
  REQUIRE(workspace.tchat("run ball -c found -d found -o branch NMX=1").status == 0);
  for (const char* source : {"-d found IRS=0 ", "-s branch IRS=1 "})
    for (const double gamma : {0.7, 0.555, 1.6, 4.0}) {
      INFO(source << gamma);
      const Outcome run = workspace.tchat("run ball -c found " + std::string(source) +
                                          "-o on NMX=2 NPR=1 PAR(Gamma)=" + std::to_string(gamma));
      INFO(run.text());
      REQUIRE(run.status == 0);
      const auto rows = workspace.points("on").front().rows;
      CHECK(rows.front().values.front() == Approx(gamma).epsilon(1e-10));
      for (const SolutionEntry& entry : workspace.solutions("on"))
        CHECK(entry.states.front()[3] == Approx(impact_cosine(entry.parameter(1), 0.7)).epsilon(1e-6));
    }
}

TEST_CASE("a second free parameter that cannot have the value asked for is told") {
  const Workspace workspace;
  workspace.run("-q -c to_grazing -d nonimpacting -o grazing");
  const std::string run = "-q -c grazing_curve -s grazing -o curve NMX=2";
  const Outcome from_label = workspace.run(run);
  INFO(from_label.text());
  CHECK_FALSE(contains(from_label.text() + workspace.read("d.curve"), "the first point has"));
  const double alpha = workspace.solutions("curve").front().parameter(1);
  const Outcome asked = workspace.run(run + " PAR(alpha)=2.9");
  INFO(asked.text());
  CHECK(contains(asked.err, "the first point has alpha = "));
  CHECK(contains(asked.err, "2.9: it is free, and found with omega fixed"));
  CHECK(workspace.solutions("curve").front().parameter(1) == Approx(alpha).epsilon(1e-9));
}

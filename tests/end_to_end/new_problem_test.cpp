// `tchat new` and `tchat constants`, and what src/docs/forcing.md advises: a problem from the template runs, and the
// period can be held while another parameter is free.
#include <catch2/catch.hpp>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

TEST_CASE("a new problem runs as it is: its Makefile arrives at the closed forms of the oscillator with a wall") {
  const Workspace workspace;
  const Outcome made = workspace.tchat("new two_walls");
  REQUIRE(made.status == 0);
  for (const char* file : {"two_walls.cpp", "two_walls.dat", "gc.two_walls", "Makefile"}) {
    CHECK(workspace.has(std::string("two_walls/") + file));
    CHECK(made.out.find(file) != std::string::npos);
  }
  const Outcome built = workspace.make("two_walls", "q.grazing_curve q.period_doubling_curve");
  INFO(built.text());
  REQUIRE(built.status == 0);
  CHECK(built.err.empty());

  const Outcome verified = workspace.make("two_walls", "verify");
  INFO(verified.text());
  CHECK(verified.status == 0);
  CHECK(contains(verified.out, "q.period_doubling_curve: "));
  CHECK_FALSE(contains(verified.out, "<<"));

  // Amplitude of the linear response = 1; period doubling of the orbit with one impact: reference value at omega = 2.1.
  const double omega = 2.1, zeta = 0.05;
  const double grazing = std::hypot(1 - omega * omega, 2 * zeta * omega);
  const auto smooth = read_solutions(workspace.read("two_walls/q.smooth"));
  CHECK(smooth.back().parameter(1) == Approx(grazing).epsilon(1e-7));
  const auto impacting = read_solutions(workspace.read("two_walls/q.impacting"));
  bool doubles = false;
  for (const SolutionEntry& solution : impacting)
    if (solution.type == 7) {
      CHECK(solution.parameter(1) == Approx(3.50618844784601).epsilon(1e-6));
      doubles = true;
    }
  CHECK(doubles);
  // Both curves meet where omega is twice the oscillator's own frequency.
  const double codimension_two = 2 * std::sqrt(1 - zeta * zeta);
  for (const char* name : {"two_walls/q.grazing_curve", "two_walls/q.period_doubling_curve"}) {
    double nearest = 1;
    for (const SolutionEntry& solution : read_solutions(workspace.read(name)))
      nearest = std::min(nearest, std::abs(solution.parameter(2) - codimension_two));
    CHECK(nearest < 1e-6);
  }
}

TEST_CASE("a new problem can be simulated, and the orbit found continued") {
  const Workspace workspace;
  REQUIRE(workspace.tchat("new wall").status == 0);
  const Outcome simulated = workspace.tchat("simulate wall/wall PAR(F)=3.6 -o wall/found --dat wall/found");
  INFO(simulated.text());
  CHECK(simulated.status == 0);
  CHECK(simulated.out.find("Periodic orbit, signature {(1,1,1)}") != std::string::npos);
  CHECK(workspace.tchat("run wall/wall -c wall/found -d wall/found -o wall/found NMX=3").status == 0);
}

TEST_CASE("a new problem never touches what is there") {
  const Workspace workspace;
  REQUIRE(workspace.tchat("new wall").status == 0);
  workspace.write("wall/wall.cpp", "mine");
  check_refused(workspace.tchat("new wall"), {"wall", "exists"});
  CHECK(workspace.read("wall/wall.cpp") == "mine");
  check_refused(workspace.tchat("new linosc.cpp"), {"letters"});
  for (const char* name : {"3walls", "two-walls", ".", ".."})
    check_refused(workspace.tchat(std::vector<std::string>{"new", name}), {"letter"});
  check_refused(workspace.tchat(std::vector<std::string>{"new", ""}), {});
}

TEST_CASE("constants: the other form says the same, also of itself, explained in words") {
  const Workspace workspace;
  const Outcome keyword = workspace.tchat("constants impacting");
  REQUIRE(keyword.status == 0);
  CHECK(keyword.out.find("UZR = {1: 3.2}") != std::string::npos);
  workspace.write("gc.keyword", keyword.out);
  const Outcome positional = workspace.tchat("constants keyword");
  REQUIRE(positional.status == 0);
  CHECK(positional.out.compare(0, 9, "4 180 0 1") == 0);
  workspace.write("gc.positional", positional.out);
  CHECK(workspace.tchat("constants positional").out == keyword.out);
  CHECK(workspace.tchat("constants positional --positional").out == positional.out);
  CHECK(workspace.tchat("constants positional NTST=77 -k").out.find("NTST = 77") != std::string::npos);

  const Outcome explained = workspace.tchat("constants impacting --explain");
  CHECK(explained.status == 0);
  for (const char* part : {"segment 1: field 1 until event function 1 falls to zero, then jump 1", "test function 1",
                           "NTST = 50", "number of mesh intervals", "an integer from 1 to 5000"})
    CHECK(explained.out.find(part) != std::string::npos);
  const Outcome all = workspace.tchat("constants");
  CHECK(all.status == 0);
  for (const char* part : {"NDIM", "GCHGRZIND", "GRSTOP", "default", "allowed", "example"})
    CHECK(all.out.find(part) != std::string::npos);

  // The words of a run show its constants; what is no constant is left out, values of parameters with a warning.
  const Outcome of_run = workspace.tchat(
      {"constants", "linosc", "-c", "impacting", "-d", "impacting", "-o", "x", "--both", "NTST=77", "PAR(alpha)=2"});
  CHECK(of_run.status == 0);
  CHECK(of_run.out.find("NTST = 77") != std::string::npos);
  CHECK(of_run.err.find("values of parameters") != std::string::npos);
  CHECK_FALSE(workspace.has("p.x"));

  check_refused(workspace.tchat("constants nosuch"), {"gc.nosuch"});
  check_refused(workspace.tchat("constants impacting NTST=0"), {"NTST", "5000"});
  check_refused(workspace.tchat("constants impacting -k --positional"), {"--help"});
}

namespace {

// A period that is held without HOLD: the parameter that is to be free is a state, a clock measures the period.
constexpr const char* held_period = R"(#include <tchat/problem.hpp>
struct VanDerPol {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T> void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = par[0] * (1.0 - x[0] * x[0]) * x[1] - x[2] * x[0];
    f[2] = T(0.0);
    f[3] = 1.0 / par[1];
  }
  template <class T> T event(int, const T* x, const T*) const { return x[1]; }
  template <class T> void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
    g[2] = x[2] + (x[3] - 1.0);
    g[3] = T(0.0);
  }
};
TCHAT_PROBLEM(VanDerPol)
)";

constexpr double period_at_1 = 6.663286859355, period_at_2 = 7.629874479712;  // of x'' - mu (1 - x^2) x' + x = 0

std::string digits(double value) {
  std::ostringstream text;
  text << std::setprecision(15) << value;
  return text.str();
}

/// One period at mu = 1 by small Runge-Kutta steps, as rows of a .dat file: t, x, v, stiffness, clock.
std::string van_der_pol_rows() {
  std::string text = "# PAR(1) = 1\n# PAR(2) = " + digits(period_at_1) + "\n";
  const int steps = 4000;
  const double h = period_at_1 / steps;
  double x = 2.00861986, v = 0.0;
  const auto slope = [](double a, double b) { return (1 - a * a) * b - a; };
  for (int i = 0; i <= steps; ++i) {
    if (i % 40 == 0)
      text += digits(i * h) + " " + digits(x) + " " + digits(v) + " 1 " + digits(static_cast<double>(i) / steps) + "\n";
    const double a1 = v, b1 = slope(x, v);
    const double a2 = v + h / 2 * b1, b2 = slope(x + h / 2 * a1, v + h / 2 * b1);
    const double a3 = v + h / 2 * b2, b3 = slope(x + h / 2 * a2, v + h / 2 * b2);
    const double a4 = v + h * b3, b4 = slope(x + h * a3, v + h * b3);
    x += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    v += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  return text;
}

}  // namespace

TEST_CASE("the period is held while the stiffness follows mu") {
  // With stiffness k the period is P(mu / sqrt k) / sqrt k; P(2) belongs to mu = 2 sqrt k, sqrt k = P(2) / P(1).
  const double root = period_at_2 / period_at_1;
  const Workspace workspace;
  workspace.write("vdp.cpp", held_period);
  workspace.write("vdp.dat", van_der_pol_rows());
  workspace.write("gc.vdp", "NDIM = 4\nICP = [1]\nRL0 = 0.2\nRL1 = 3\nDS = 0.05\nDSMAX = 0.2\nNTST = 80\n");
  const Outcome run = workspace.tchat({"run", "vdp", "PAR(2)=6.663286859355", "UZR={-1: " + digits(2 * root) + "}"});
  INFO(run.text());
  REQUIRE(run.status == 0);
  const SolutionEntry at_end = workspace.solutions("vdp").back();
  CHECK(at_end.parameter(61) == Approx(period_at_1).epsilon(1e-6));
  CHECK(at_end.states.at(0).at(2) == Approx(root * root).epsilon(1e-5));
}

// Lyapunov exponents by the real program: of periodic orbits ln |mu| / T with the multipliers of tchat run, of a torus,
// of problems as formulas and in Fortran, which has no derivatives.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "end_to_end/bad_input.hpp"
#include "published/chain.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

struct Exponent {
  double value = 0.0, bar = 0.0;
};

/// The rows of the table of exponents.
std::vector<Exponent> exponents_in(const std::string& text) {
  std::istringstream lines(text);
  std::vector<Exponent> exponents;
  bool is_table = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("Lyapunov exponents per ", 0) == 0) is_table = true;
    int number = 0;
    char value[40], plus_minus[10];
    Exponent exponent;
    const int found = std::sscanf(line.c_str(), " %d %39s %9s %lf", &number, value, plus_minus, &exponent.bar);
    if (!is_table || found < 2 || number != static_cast<int>(exponents.size()) + 1) continue;
    exponent.value = std::string(value) == "-infinity" ? -std::numeric_limits<double>::infinity() : std::stod(value);
    exponents.push_back(exponent);
  }
  return exponents;
}

/// What tchat run says of the orbit found: ln |mu| / T, the structural multiplier replaced by the 0 along the flow.
std::vector<double> by_multipliers(const Workspace& workspace, const std::string& problem) {
  const Outcome run = workspace.tchat("run " + problem + " -c found -d found -o onward NMX=1 IID=2");
  INFO(run.text());
  REQUIRE(run.status == 0);
  const SolutionEntry start = workspace.solutions("onward").front();
  double period = 0.0;
  for (const int k : start.free_parameters) period += k >= 61 ? start.parameter(k) : 0.0;
  std::vector<double> exponents;
  bool has_flow = false;
  const std::vector<DiagnosticPoint> points = read_diagnostics(workspace.read("d.onward"));
  for (const auto& mu : points.front().multipliers) {
    // Of several zeros, to rounding, one is structural; the others are directions lost in the jumps.
    const bool is_zero = std::abs(mu) < 1e-9;
    const double lost = has_flow ? -std::numeric_limits<double>::infinity() : 0.0;
    exponents.push_back(is_zero ? lost : std::log(std::abs(mu)) / period);
    has_flow = has_flow || is_zero;
  }
  std::sort(exponents.rbegin(), exponents.rend());
  return exponents;
}

void check_orbit(const Workspace& workspace, const std::string& problem, const std::string& arguments) {
  INFO("tchat simulate " << problem << ' ' << arguments);
  const Outcome simulated =
      workspace.tchat("simulate " + problem + " " + arguments + " --lyapunov --accuracy 1e-6 --rows 0 --dat found");
  INFO(simulated.text());
  REQUIRE(simulated.status == 0);
  CHECK(simulated.out.find("a stable periodic orbit.") != std::string::npos);
  CHECK(simulated.out.find("along the flow, where it is zero") != std::string::npos);
  const std::vector<Exponent> exponents = exponents_in(simulated.out);
  const std::vector<double> expected = by_multipliers(workspace, problem);
  REQUIRE(exponents.size() == expected.size());
  for (std::size_t j = 0; j < expected.size(); ++j) {
    CAPTURE(j, exponents[j].value, exponents[j].bar, expected[j]);
    if (std::isinf(expected[j])) {
      CHECK(exponents[j].value == expected[j]);
      continue;
    }
    CHECK(exponents[j].bar <= 1e-6);
    CHECK(std::abs(exponents[j].value - expected[j]) < 1e-6);
    CHECK(std::abs(exponents[j].value - expected[j]) <= 2.0 * exponents[j].bar);
  }
}

void copy_problem(const Workspace& workspace, const std::string& library) {
  fs::copy_file(library, workspace.file(fs::path(library).filename().string()));
}

const std::string logistic = R"(par a=4
init clock=0, c=0.4
clock' = 1
c' = 0
event tick = 1 - clock
jump iterate: clock -> clock - 1, c -> a*c*(1 - c)
after any: tick -> iterate
)";

}  // namespace

TEST_CASE("exponents of periodic orbits are those of tchat run: linosc") {
  const Workspace workspace;
  check_orbit(workspace, "linosc", "PAR(alpha)=1.2 PAR(omega)=1.6");
}

TEST_CASE("exponents of periodic orbits are those of tchat run: mems, with impacts, slip and stick") {
  const Workspace workspace;
  copy_problem(workspace, MEMS_LIBRARY);
  check_orbit(workspace, "mems", "PAR(V)=0.79013593844 PAR(omega)=0.8");
}

TEST_CASE("exponents of periodic orbits are those of tchat run: rand3d, next to grazing") {
  const Workspace workspace;
  copy_problem(workspace, RAND3D_LIBRARY);
  check_orbit(workspace, "rand3d", "PAR(m)=0.28 PAR(mu)=-0.799 --state=-0.799,0.337,0.63 --mode 1,1,1");
  check_orbit(workspace, "rand3d", "PAR(m)=0.39 PAR(mu)=-0.825");
}

TEST_CASE("exponents of a torus: two zeros, the others as published for it") {
  // rand4d without its wall, A = 1.1: 0, 0, -0.2710, -0.4777 and -2 of the circle that drives it.
  const Workspace workspace;
  copy_problem(workspace, RAND4D_LIBRARY);
  const Outcome torus = workspace.tchat(
      "simulate rand4d PAR(mu)=-100 PAR(A)=1.1 --transient-events 300 --events 1500 --rows 0 --lyapunov");
  INFO(torus.text());
  REQUIRE(torus.status == 0);
  const std::vector<Exponent> exponents = exponents_in(torus.out);
  const std::vector<double> expected = {0.0, 0.0, -0.2710, -0.4777, -2.0};
  REQUIRE(exponents.size() == 5);
  for (std::size_t j = 0; j < 5; ++j) {
    CAPTURE(j, exponents[j].value, exponents[j].bar);
    CHECK(std::abs(exponents[j].value - expected[j]) < 1e-4);
    CHECK(std::abs(exponents[j].value - expected[j]) <= 2.0 * exponents[j].bar + 5e-5);  // digits of the last two
  }
  CHECK(exponents[0].bar < 1e-4);
  CHECK(torus.out.find("2 zero exponents, none positive: as of quasi-periodic motion, on a torus of dimension 2") !=
        std::string::npos);
}

TEST_CASE("exponents of formulas, and in Fortran without derivatives") {
  const Workspace workspace;
  workspace.write("logistic.tch", logistic);
  const Outcome chaotic = workspace.tchat("simulate logistic --lyapunov --accuracy 0.01 --rows 0");
  INFO(chaotic.text());
  REQUIRE(chaotic.status == 0);
  const std::vector<Exponent> exponents = exponents_in(chaotic.out);
  REQUIRE(exponents.size() == 2);
  CHECK(std::abs(exponents[0].value - std::log(2.0)) <= 2.0 * exponents[0].bar);
  CHECK(exponents[0].bar <= 0.01);
  CHECK(std::abs(exponents[1].value) < 1e-5);
  CHECK(chaotic.out.find("1 positive exponent: the motion is chaotic.") != std::string::npos);

  const Outcome of_map = workspace.tchat("simulate logistic --lyapunov --section 1 --events 2000 --rows 0");
  INFO(of_map.text());
  REQUIRE(exponents_in(of_map.out).size() == 1);
  CHECK(std::abs(exponents_in(of_map.out)[0].value - std::log(2.0)) <= 2.0 * exponents_in(of_map.out)[0].bar);

  fs::copy_file(PROBLEMS "/mems_fortran/mems.f.1", workspace.file("mems.f"));
  fs::copy_file(PROBLEMS "/mems_fortran/gc.mems.3", workspace.file("gc.mems"));
  const Outcome fortran =
      workspace.tchat("simulate mems PAR(1)=0.79013593844 PAR(2)=0.8 --state 0,0.3,0,0,1 --lyapunov 3 --rows 0");
  INFO(fortran.text());
  REQUIRE(fortran.status == 0);
  const std::vector<Exponent> of_mems = exponents_in(fortran.out);
  REQUIRE(of_mems.size() == 3);
  const double period = 3.14159265358979323846 / 0.8;
  CHECK(std::abs(of_mems[1].value - std::log(0.595826261) / period) < 1e-5);
  CHECK(std::abs(of_mems[2].value - std::log(0.352713557) / period) < 1e-5);
}

TEST_CASE("exponents: what follows --lyapunov is its number or an assignment") {
  const Workspace workspace;
  const std::string rest = " PAR(omega)=1.6 --rows 0";
  const Outcome before = workspace.tchat("simulate linosc PAR(alpha)=1.2 --lyapunov" + rest);
  const Outcome behind = workspace.tchat("simulate linosc --lyapunov PAR(alpha)=1.2" + rest);
  const Outcome other = workspace.tchat("simulate linosc --lyapunov PAR(zeta)=0.2" + rest);
  INFO(before.text() << behind.text() << other.text());
  REQUIRE(before.status == 0);
  REQUIRE(behind.status == 0);
  REQUIRE(other.status == 0);
  const std::vector<Exponent> a = exponents_in(before.out), b = exponents_in(behind.out), c = exponents_in(other.out);
  REQUIRE(a.size() == 4);
  REQUIRE(b.size() == 4);
  REQUIRE(c.size() == 4);
  for (std::size_t j = 0; j < 4; ++j) CHECK(a[j].value == b[j].value);
  // It is taken, not dropped: the divergence is -2 zeta, and impacts of restitution 0.8 at most one a period add
  // ln(0.64) to it.
  CHECK(b[1].value + b[2].value > -0.1 - 0.446 / 3.92 - 0.01);
  CHECK(c[1].value + c[2].value < -0.4 + 0.001);
  CHECK(exponents_in(workspace.tchat("simulate linosc --lyapunov 2 PAR(alpha)=1.2" + rest).out).size() == 2);
  check_refused(workspace.tchat("simulate linosc --lyapunov PAR(nosuch)=1.2"), {"nosuch"});
  check_refused(workspace.tchat("simulate linosc --lyapunov two"), {"--lyapunov", "'two'"});
}

TEST_CASE("exponents: mistakes and motions that end are told in one sentence") {
  const Workspace workspace;
  check_refused(workspace.tchat("simulate linosc --lyapunov 5"), {"5 Lyapunov exponents", "has 4, one for each state"});
  check_refused(workspace.tchat("simulate linosc --lyapunov 4 --section 1"), {"has 3 on a section"});
  check_refused(workspace.tchat("simulate linosc --lyapunov --section 9"), {"section 9", "event functions 1 to 3"});
  check_refused(workspace.tchat("simulate linosc --section 1"), {"--section", "--lyapunov"});
  check_refused(workspace.tchat("simulate linosc --lyapunov 0"), {"--lyapunov"});
  copy_problem(workspace, MEMS_LIBRARY);
  const Outcome chatters = workspace.tchat("simulate mems --lyapunov");
  CHECK(chatters.status == 0);
  CHECK(chatters.out.find("No Lyapunov exponents: the motion ends where events accumulate.") != std::string::npos);
}

// Relaxation and stiff cycles from simulation to branch, without a hand: the run that simulate recommends starts at the
// parameter simulated, with the period that direct integration gives, and goes on both ways.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// x' = field, cut where event falls through zero; x, p, f are C arrays, PAR(1) is varied.
struct Cycle {
  const char* name;
  const char* field;
  const char* event;
  std::vector<double> parameters, state;
};

const char* const van_der_pol = "f[0] = x[1]; f[1] = p[0] * (1.0 - x[0] * x[0]) * x[1] - x[0];";
const char* const lienard = "f[0] = p[0] * (x[1] - x[0] * x[0] * x[0] / 3.0 + x[0]); f[1] = -x[0] / p[0];";
const char* const nagumo =
    "f[0] = x[0] - x[0] * x[0] * x[0] / 3.0 - x[1] + p[0]; f[1] = p[1] * (x[0] + 0.7 - 0.8 * x[1]);";
/// Two reactions A -> B -> C with heat: the concentration's deficit and the temperature.
const char* const reactor =
    "const T r = p[0] * (1.0 - x[0]) * exp(x[1]); f[0] = -x[0] + r; f[1] = -x[1] + p[1] * r - p[2] * x[1];";
const char* const oregonator2 =
    "f[0] = (x[0] * (1.0 - x[0]) - p[0] * x[1] * (x[0] - p[1]) / (x[0] + p[1])) / p[2]; f[1] = x[0] - x[1];";
/// Field and Noyes' three concentrations, as logarithms.
const char* const oregonator3 =
    "f[0] = 77.27 * (exp(x[1] - x[0]) - exp(x[1]) + 1.0 - 8.375e-6 * exp(x[0]));"
    "f[1] = (-1.0 - exp(x[0]) + p[0] * exp(x[2] - x[1])) / 77.27; f[2] = 0.161 * (exp(x[0] - x[2]) - 1.0);";
const char* const brusselator =
    "f[0] = p[1] - (p[0] + 1.0) * x[0] + x[0] * x[0] * x[1]; f[1] = p[0] * x[0] - x[0] * x[0] * x[1];";
/// A mass on a belt of speed PAR(1), friction that falls with the slip.
const char* const stick_slip =
    "const T s = p[0] - x[1]; f[0] = x[1]; f[1] = -x[0] + tanh(s / 0.02) * (0.5 + 0.5 * exp(-s * s));";
const char* const rayleigh = "f[0] = x[1]; f[1] = p[0] * (1.0 - x[1] * x[1] / 3.0) * x[1] - x[0];";
const char* const morris_lecar =
    "const T m = 0.5 * (1.0 + tanh((x[0] + 1.2) / 18.0)); const T w = 0.5 * (1.0 + tanh((x[0] - 12.0) / 17.4));"
    "f[0] = (p[0] - 2.0 * (x[0] + 60.0) - 4.0 * m * (x[0] - 120.0) - 8.0 * x[1] * (x[0] + 84.0)) / 20.0;"
    "f[1] = 0.066667 * (w - x[1]) * cosh((x[0] - 12.0) / 34.8);";
/// The section u2' = 0, which lies along the slow part.
const char* const reactor_maximum = "p[1] * (1.0 - x[0]) * exp(x[1]) * p[0] - (1.0 + p[2]) * x[1]";

std::string source(const Cycle& cycle) {
  const auto list = [](const std::vector<double>& values) {
    std::ostringstream text;
    text.precision(17);
    for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? ", " : "") << values[i] << "";
    return text.str();
  };
  std::ostringstream text;
  text << "#include <tchat/problem.hpp>\nstruct Cycle {\n  static constexpr int dimension = " << cycle.state.size()
       << ", parameters = " << cycle.parameters.size() << ", fields = 1, events = 1, jumps = 1;\n"
       << "  static constexpr double initial_parameters[] = {" << list(cycle.parameters) << "};\n"
       << "  static constexpr double initial_state[] = {" << list(cycle.state) << "};\n"
       << "  template <class T> void field(int, const T* x, const T* p, T* f) const { " << cycle.field << " }\n"
       << "  template <class T> T event(int, const T* x, const T* p) const { (void)p; return T(" << cycle.event
       << "); }\n"
       << "  template <class T> void jump(int, const T* x, const T*, T* g) const {\n"
       << "    for (int i = 0; i < dimension; ++i) g[i] = x[i];\n  }\n};\nTCHAT_PROBLEM(Cycle)\n";
  return text.str();
}

/// v of the line `KEY v` or `KEY = v`.
double value_after(const std::string& text, const std::string& key) {
  const auto at = text.find(key);
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + key.size()));
}

/// None of these branches has a branch point. One may shrink to an equilibrium before its 21 points, and says so.
void check_cycle(const Cycle& cycle, const std::string& constants, double accuracy) {
  INFO(cycle.name << " with PAR(1) = " << cycle.parameters.front() << constants);
  const Workspace workspace;
  workspace.write("cycle.cpp", source(cycle));
  const Outcome simulated = workspace.tchat("simulate cycle --dat found");
  INFO(simulated.text());
  REQUIRE(simulated.status == 0);
  const Outcome run = workspace.tchat("run cycle -c found -d found -o found --both NMX=21" + constants);
  INFO(run.text());
  REQUIRE(run.status == 0);
  const auto sections = workspace.points("found");
  REQUIRE(sections.size() == 2);
  const double period = value_after(workspace.read("found.dat"), "# period ");
  for (const PointSection& section : sections) {
    CHECK((section.rows.size() == 21 || run.text().find("equilibrium") != std::string::npos));
    CHECK(section.rows.size() > 10);
    CHECK(section.rows.front().values.front() == Approx(cycle.parameters.front()).epsilon(1e-10));
    CHECK(std::abs(section.rows.front().values.back() / period - 1.0) < accuracy);
    for (const PointRow& row : section.rows) CHECK((row.type != -9 && std::abs(row.type) != 6));
  }
  CHECK(workspace.solutions("found").front().parameter(1) == cycle.parameters.front());
}

}  // namespace

TEST_CASE("sharp cycles start and run by themselves") {
  check_cycle({"van der Pol", van_der_pol, "x[1]", {100}, {2, 0}}, "", 1e-9);
  check_cycle({"reactor, section u2' = 0", reactor, reactor_maximum, {0.16, 17, 3}, {0.2, 3.5}}, "", 1e-9);
  check_cycle({"Oregonator", oregonator2, "x[0] - 0.1", {1, 8e-4, 0.004}, {0.5, 0.1}}, "", 1e-8);
}

TEST_CASE("a sharp cycle on a coarser mesh than simulate recommends") {
  check_cycle({"reactor, section u2' = 0", reactor, reactor_maximum, {0.16, 17, 3}, {0.2, 3.5}}, " NTST=50", 1e-7);
}

TEST_CASE("a sharp cycle on a finer mesh than that of its data, and on a coarser one") {
  check_cycle({"Oregonator", oregonator2, "x[0] - 0.1", {1, 8e-4, 0.004}, {0.5, 0.1}}, " NTST=400", 1e-10);
  check_cycle({"Lienard", lienard, "x[0]", {100}, {2, 0.5}}, " NTST=60", 1e-8);
}

TEST_CASE("a step that fails on an adapted mesh is tried again on the mesh before") {
  const Cycle cycle{"van der Pol", van_der_pol, "x[1]", {100}, {2, 0}};
  const Workspace workspace;
  workspace.write("cycle.cpp", source(cycle));
  REQUIRE(workspace.tchat("simulate cycle --dat found").status == 0);
  // So coarse that Newton's method fails after most adaptations, also with the smallest step.
  const Outcome run = workspace.tchat("run cycle -c found -d found -o found NMX=21 NTST=50 ERRMAX=0");
  INFO(run.text());
  REQUIRE(run.status == 0);
  CHECK(workspace.read("d.found").find("on the mesh before its adaptation") != std::string::npos);
  const auto rows = rows_of(workspace.points("found"));
  CHECK(rows.size() == 21);
  for (const PointRow& row : rows) CHECK(row.type != -9);
}

TEST_CASE("twenty sharp cycles", "[.][long]") {
  for (const double mu : {1.0, 5.0, 10.0, 20.0, 50.0, 100.0})
    check_cycle({"van der Pol", van_der_pol, "x[1]", {mu}, {2, 0}}, "", 1e-9);
  for (const double mu : {20.0, 100.0}) check_cycle({"Lienard", lienard, "x[0]", {mu}, {2, 0.5}}, "", 1e-9);
  for (const double epsilon : {0.08, 0.01})
    check_cycle({"FitzHugh-Nagumo", nagumo, "x[0]", {0.5, epsilon}, {-1, -0.5}}, "", 1e-9);
  for (const double epsilon : {0.04, 0.004})
    check_cycle({"Oregonator", oregonator2, "x[0] - 0.1", {1, 8e-4, epsilon}, {0.5, 0.1}}, "", 1e-8);
  check_cycle({"Oregonator, three states", oregonator3, "x[0] - 5.0", {1}, {1, 2, 1}}, "", 1e-9);
  for (const double b : {3.0, 8.0}) check_cycle({"Brusselator", brusselator, "x[0] - 1.0", {b, 1}, {1, 2}}, "", 1e-8);
  for (const double d : {0.16, 0.17}) check_cycle({"reactor", reactor, "x[1] - 3.0", {d, 17, 3}, {0.2, 3.5}}, "", 1e-8);
  check_cycle({"reactor, section u2' = 0", reactor, reactor_maximum, {0.16, 17, 3}, {0.2, 3.5}}, "", 1e-9);
  check_cycle({"stick-slip", stick_slip, "x[1]", {0.3}, {1.2, 0}}, "", 1e-9);
  check_cycle({"Rayleigh", rayleigh, "x[1]", {20}, {13, 0.1}}, "", 1e-9);
  check_cycle({"Morris-Lecar", morris_lecar, "x[0]", {45}, {-20, 0.1}}, "", 1e-9);
}

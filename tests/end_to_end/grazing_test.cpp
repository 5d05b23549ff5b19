// tchat grazing through the binary: the linear oscillator against its closed forms, contacts on and off the section,
// and what it refuses.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

constexpr double zeta = 0.05, restitution = 0.8;

Outcome succeed_silently(const Workspace& workspace, const std::vector<std::string>& words) {
  const Outcome outcome = workspace.succeed(words);
  CHECK(outcome.err.empty());
  return outcome;
}

/// The numbers behind `name` at the beginning of a line.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(name)) continue;
    std::istringstream words(line.substr(name.size()));
    std::vector<double> result;
    for (double value = 0.0; words >> value;) result.push_back(value);
    return result;
  }
  FAIL("no line " << name << " in\n" << text);
  return {};
}

void check_row(const std::string& text, const std::string& name, const std::vector<double>& expected) {
  INFO(name);
  const std::vector<double> found = numbers_after(text, name);
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - expected[i]) < 1e-9);
}

/// xi_n wherever it stands.
double xi(const std::string& text, int n) {
  const std::string name = fmt::format("xi_{} ", n);
  const std::size_t at = text.find(name);
  REQUIRE(at != std::string::npos);
  return std::stod(text.substr(at + name.size()));
}

/// The response A cos(omega t - phi) with A = 1 touches the wall where omega t = phi.
void check_against_closed_form(const std::string& text, double omega) {
  const double phi = std::atan2(2.0 * zeta * omega, 1.0 - omega * omega);
  const double natural = std::sqrt(1.0 - zeta * zeta);
  check_row(text, "x*", {1.0, 0.0, std::sin(phi), std::cos(phi)});
  const double stretch = -(1.0 + restitution) * std::sqrt(2.0);  // -(1 + r) sqrt(2/a*) omega, a* = omega^2
  check_row(text, "B ", {0.0, 0.0, stretch * std::cos(phi), -stretch * std::sin(phi)});
  CHECK(numbers_after(text, "a* =").front() == Approx(omega * omega).epsilon(1e-11));
  const double period = 2.0 * std::acos(-1.0) / omega;
  for (int n = 1; n <= 5; ++n) {
    const double expected =
        (1.0 + restitution) * omega * omega * std::exp(-zeta * n * period) * std::sin(n * natural * period) / natural;
    CHECK(std::abs(xi(text, n) - expected) < 1e-8);
  }
}

/// With one impact of velocity v a period the free oscillation adds -(1 + r) v S to x1 at the impact, S = sum over j >=
/// 1 of exp(-zeta j T) sin(omega_d j T) / omega_d: to first order (alpha - alpha_grazing) / alpha_grazing = (1 + r) v
/// S.
void check_birth(const std::string& text, double omega) {
  const double period = 2.0 * std::acos(-1.0) / omega, natural = std::sqrt(1.0 - zeta * zeta);
  double sum = 0.0;
  for (int j = 1; j < 500; ++j) sum += std::exp(-zeta * j * period) * std::sin(natural * j * period) / natural;
  const double slope = std::hypot(1.0 - omega * omega, 2.0 * zeta * omega) * (1.0 + restitution) * sum;
  const std::string row = slope > 0.0 ? "    1  alpha > " : "    1  alpha < ";
  const std::vector<double> found = numbers_after(text, row);  // alpha, penetration, velocity, multiplier
  REQUIRE(found.size() == 4);
  CHECK(found[2] == Approx(-1.0 / std::abs(slope)).epsilon(1e-6));
}

void run_to_contact(const Workspace& workspace) { workspace.run("-c to_grazing -d nonimpacting -o smooth -q"); }

}  // namespace

TEST_CASE("grazing: contact on the section of the linear oscillator, by its closed forms") {
  const Workspace workspace;
  run_to_contact(workspace);
  const Outcome outcome = succeed_silently(workspace, {"grazing", "q.smooth", "GR1", "-p", "linosc"});
  const double omega = workspace.solutions("smooth").back().parameter(2);
  check_against_closed_form(outcome.out, omega);
  CHECK(contains(outcome.out, "contact brings jump 1 (impact)"));
  CHECK(contains(outcome.out, "y^2.00 (order 1/2"));
  CHECK(contains(outcome.out, "Verdict: "));
}

TEST_CASE("grazing: labels of a grazing curve") {
  const Workspace workspace;
  run_to_contact(workspace);
  workspace.run("-c grazing_curve -s smooth -o curve NMX=20 -q");
  for (const char* label : {"UZ1", "XI1"}) {
    CAPTURE(label);
    const Outcome outcome =
        succeed_silently(workspace, {"grazing", "curve", label, "-p", "linosc", "--parameter", "alpha"});
    const std::size_t at = outcome.out.find("omega = ");
    REQUIRE(at != std::string::npos);
    const double omega = std::stod(outcome.out.substr(at + 8));
    check_against_closed_form(outcome.out, omega);
    if (std::string(label) == "UZ1") check_birth(outcome.out, omega);
  }
}

TEST_CASE("grazing: a contact inside a segment is that on the section") {
  const Workspace workspace;
  run_to_contact(workspace);
  const Outcome on_section = succeed_silently(workspace, {"grazing", "q.smooth", "GR1", "-p", "linosc"});
  // Once more, cut at the minimum of x1: event 3.
  succeed_silently(workspace, {"simulate", "linosc", "PAR(omega)=2.2", "--signature", "1,3,2", "--transient-time",
                               "300", "--dat", "low", "--free", "omega", "-q"});
  workspace.run("-c low -d low -o low GCHGRZIND=[[1]] GCIPSI=[1] DS=-0.02 RL0=1.5 EPSL=1e-10 EPSU=1e-10 EPSS=1e-9 -q");
  const Outcome inside = succeed_silently(workspace, {"grazing", "q.low", "GR1", "-p", "linosc"});
  CHECK(contains(inside.out, "{(1,3,2), (1,1,0)}"));
  for (const char* name : {"x*", "B ", "beta", "f "}) check_row(inside.out, name, numbers_after(on_section.out, name));
  for (int n = 1; n <= 5; ++n) CHECK(std::abs(xi(inside.out, n) - xi(on_section.out, n)) < 1e-9);
}

TEST_CASE("grazing: a point given by hand, with another section") {
  const Workspace workspace;
  const double omega = 2.0, phi = std::atan2(2.0 * zeta * omega, 1.0 - omega * omega);
  const double alpha = std::hypot(1.0 - omega * omega, 2.0 * zeta * omega);
  const std::string parameter = fmt::format("PAR(alpha)={:.17g}", alpha);
  const std::string state = fmt::format("1,0,{:.17g},{:.17g}", std::sin(phi), std::cos(phi));
  const Outcome outcome = succeed_silently(
      workspace, {"grazing", "linosc", parameter, "--state", state, "--mode", "1,1,1", "--section", "y1"});
  check_row(outcome.out, "x*", {1.0, 0.0, std::sin(phi), std::cos(phi)});
  CHECK(contains(outcome.out, "Discontinuity map on P (h_P = 0)"));
  CHECK(contains(outcome.out, "Discontinuity map on P' (constant y1)"));
  CHECK(contains(outcome.out, "A, xi_n and the verdict need the label of an orbit"));

  const std::vector<std::string> rough{"grazing", "linosc", parameter, "--state", "1.001,0.002,0.066,-0.998",
                                       "--mode",  "1,1,1"};
  check_refused(workspace.tchat(rough), {"is no grazing point of event 1 (wall)", "-1.000e-03", "--correct"});
  std::vector<std::string> corrected = rough;
  corrected.emplace_back("--correct");
  const Outcome mended = succeed_silently(workspace, corrected);
  CHECK(contains(mended.out, "Corrected by 2.236e-03"));
  check_row(mended.out, "x*", {1.0, 0.0, 0.066, -0.998});
}

TEST_CASE("grazing: what is refused, and why") {
  const Workspace workspace;
  run_to_contact(workspace);
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    CAPTURE(arguments);
    check_refused(workspace.tchat("grazing " + arguments), parts);
  };
  refused("q.smooth -p linosc", {"LABEL", "GR1", "--state and --mode"});
  refused("q.smooth EP1 -p linosc", {"is no grazing point", "choose a GR label", "IPS = 150"});
  refused("q.smooth GR9 -p linosc", {"no point GR9"});
  refused("q.nothing GR1 -p linosc", {"q.nothing"});
  refused("q.smooth GR1 -p linosc --jump 2", {"jump 2 (identity)", "the identity", "GRJUMP"});
  refused("q.smooth GR1 -p linosc --jump 3", {"--jump 3", "jumps 1 to 2"});
  refused("q.smooth GR1 -p linosc --section z", {"--section z", "1 (wall), 2 (maximum of x1)", "x1, x2, y1, y2"});
  refused("q.smooth GR1 -p linosc --section 1", {"tangent", "surface in contact"});
  refused("q.smooth GR1 -p linosc --parameter beta", {"--parameter", "beta", "omega"});
  refused("q.smooth GR1 -p linosc --mode 1,1,1", {"--mode", "only with --state"});
  refused("q.smooth GR1 -p linosc PAR(omega)=2", {"PAR(omega)=2", "only with --state"});
  refused("linosc --state 1,0,0,-1", {"--mode 1,1,1"});
  refused("linosc --state 1,0,0,-1 --mode 1,1,1;1,1,2", {"--mode", "one index vector"});
  refused("linosc --state 1,0,0,-1 --mode 1,7,1", {"--mode 1,7,1"});
  refused("linosc --state 1,0,0 --mode 1,1,1", {"--state 1,0,0", "4 states"});
  refused("linosc --state 1,0,0,-1 --mode 1,1,1 --parameter omega", {"--parameter", "no return"});
  refused("linosc --state 1,0,0,-1 --mode 1,1,2", {"the identity"});
  // From the forbidden side: the force pulls away from the wall's inside, so that x1 has a minimum at x1 = 1.
  refused("linosc --state 1,0,0,1 --mode 1,1,1", {"a* = -2 is negative", "maximum", "forbidden side"});
}

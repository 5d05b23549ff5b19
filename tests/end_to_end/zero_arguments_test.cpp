// Functions with a value and no derivatives, as a root at zero: named with the state; and orbits without a section.
#include <catch2/catch.hpp>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

/// A forced oscillator that starts at rest, with another term in its force.
std::string with_term(const std::string& term, const std::string& jump = "jump identity: y -> y") {
  return "par a=0.1\ninit x=0, y=0, c=1, s=0\nx' = y\ny' = " + term + " - x + c\nc' = -s\ns' = c\n" +
         "event section = y\n" + jump + "\nafter any: section -> " + jump.substr(5, jump.find(':') - 5) + "\n";
}

/// The Brusselator with a wall that nothing happens at, as a smooth orbit.
const char* const brusselator = R"(par A=1, B=2.2
init x=1.5, y=1.7
x' = A - (B+1)*x + x^2*y
y' = B*x - x^2*y
event wall = 2.5 - x
)";
const char* const more_events = "event section = y - 1.95\n";
const char* const jumps = R"(jump back: y -> y + 0.3*(A - (B+1)*x + x^2*y)
jump identity: x -> x
after any: wall -> back
)";
const char* const smooth_constants = R"(NDIM = 2, IPS = 180
ICP = [B]
GCFIND = [1], GCHIND = [0], GCGIND = [0], GCHGRZIND = [[1]], GCIPSI = [1]
NTST = 40, NMX = 60, RL1 = 4, DS = 0.05, DSMAX = 0.3
)";

}  // namespace

TEST_CASE("simulate and check name a function without derivatives, and the state") {
  const Workspace workspace;
  workspace.write("edge.tch", with_term("a*asin(c)"));
  const Outcome edge = workspace.tchat("simulate edge --time 1");
  CHECK(edge.status == 1);
  CHECK(contains(edge.err, "flow has no finite derivatives at x = (0, "));
  workspace.write("jumps.tch", with_term("-0.1*y", "jump rough: x -> 0.5*x, y -> -0.5*sqrt(y^2)"));
  const Outcome jump = workspace.tchat("simulate jumps --lyapunov");
  CHECK(contains(jump.out, "rough has no finite derivatives at x = ("));

  for (const char* const term : {"a*sqrt(x^2 + y^2)", "a*cbrt(y)", "a*hypot(x, y)", "a*atan2(x, y)", "a*asin(c)"}) {
    INFO(term);
    workspace.write("term.tch", with_term(term));
    const Outcome noted = workspace.tchat("check term");
    CHECK(noted.status == 0);
    CHECK(contains(noted.out, "flow has no finite derivatives at x = (0, 0, 1, 0)"));
    const Outcome given = workspace.tchat("check term --state 0,0,1,0");
    CHECK(given.status == 1);
    CHECK(contains(given.out, "fault: flow has no finite derivatives at x = (0, 0, 1, 0)"));
    CHECK_FALSE(contains(given.out, "nan"));
  }
  workspace.write("term.tch", with_term("a*sqrt(x^2 + y^2 + 1)"));
  CHECK_FALSE(contains(workspace.tchat("check term").out, "no finite derivatives"));
}

TEST_CASE("an orbit without a section is cut at its contact, and for other targets resegment says what it needs") {
  const Workspace workspace;
  workspace.write("bru.tch", std::string(brusselator) + jumps);
  workspace.write("gc.bru", smooth_constants);
  // The ellipse of the Hopf bifurcation at B = 2.
  workspace.write("bru.dat",
                  "0 1.5 1.7\n0.785398 1.353553 1.492893\n1.570796 1 1.7\n2.356194 0.646447 2.2\n3.141593 0.5 2.7\n"
                  "3.926991 0.646447 2.907107\n4.712389 1 2.7\n5.497787 1.353553 2.2\n6.283185 1.5 1.7\n");
  REQUIRE(workspace.tchat("run bru").status == 0);
  const std::string simulation = "tchat simulate bru -s bru IRS=1 --signature 1,2,2 --dat bru_cut";
  const std::string run = "tchat run bru -c bru_cut -d bru_cut -o bru_cut";
  for (const char* const command : {"resegment q.bru 1 --to double -o none", "resegment q.bru 1 --to rotate -o none"}) {
    INFO(command);
    const Outcome refused = workspace.tchat(command);
    check_refused(refused, {"the orbit has no section", simulation, run});
    CHECK_FALSE(contains(refused.err, "GCHIND(2)"));
  }
  // What grazes is cut there: both local analyses are of the same contact, with a section and without.
  const Outcome smooth = workspace.tchat("grazing q.bru GR1");
  INFO(smooth.text());
  CHECK(smooth.status == 0);
  for (const char* const target : {"grazing-curve", "impacting"})
    CHECK(workspace.tchat(std::string("resegment q.bru GR1 -o cut --to ") + target).status == 0);
  // With the event function that the message asks for, its commands run.
  workspace.write("bru.tch", std::string(brusselator) + more_events + jumps);
  for (const std::string& command : {simulation, run + " ICP=[B] RL1=4 DS=0.05 NMX=30 DSMAX=0.1"}) {
    const Outcome outcome = workspace.tchat(command.substr(6));
    INFO(command << "\n" << outcome.text());
    CHECK(outcome.status == 0);
  }
  const Outcome grazing = workspace.tchat("grazing q.bru_cut GR1 -p bru");
  INFO(grazing.text());
  CHECK(grazing.status == 0);
  // The orbits end 1e-9 from each other; the parameter at contact and the verdict's determinant are located to that.
  const auto number_after = [](const Outcome& report, const std::string& text) {
    const std::size_t at = report.out.find(text);
    REQUIRE(at != std::string::npos);
    return std::stod(report.out.substr(at + text.size()));
  };
  for (const char* const text : {"A = 1, B = ", "det(Id - A L) det(Id - A) = "})
    CHECK(number_after(smooth, text) == Approx(number_after(grazing, text)).epsilon(1e-7));
}

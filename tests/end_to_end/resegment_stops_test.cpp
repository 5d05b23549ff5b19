// Contacts with surfaces that change the field alone: what resegment makes of them, and what it refuses.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

const std::string top = R"(
par A=3, w=2.5, z=0.05, k=4, g=1, push=0
init x=0, v=0, s=0, c=1
force = A*c - 2*z*v - x
v' = force
s' = (1-s^2-c^2)*s + w*c
c' = (1-s^2-c^2)*c - w*s
field free
x' = v
field beyond
)";
const std::string events = R"(
event touch = g - x
event leave = x - g
event top = v
event phase = s
)";
const std::string follows = R"(
after touch: beyond until leave -> identity
after any: free until touch -> identity, top -> identity
)";

/// x' = v + push and x'' = force - k (x - g) beyond x = g.
std::string oscillator(const std::string& beyond, const std::string& after) { return top + beyond + events + after; }
const std::string spring = "x' = v + push\nv' = force - k*(x-g)";

/// q.free of the oscillator, with the label GR1 where it touches.
void run_to_contact(const Workspace& workspace, const std::string& text) {
  workspace.write("stop.tch", text);
  REQUIRE(workspace.tchat("simulate stop --signature 1,3,1 --dat free").status == 0);
  REQUIRE(
      workspace.tchat("run stop -c free -d free -o free DS=0.05 DSMAX=0.5 GCHGRZIND=[[1]] GCIPSI=[1] RL1=30").status ==
      0);
}

double grazing() { return std::hypot(1.0 - 2.5 * 2.5, 2.0 * 0.05 * 2.5); }

const std::string born = "resegment q.free GR1 --to impacting -o born -p stop ";

}  // namespace

TEST_CASE("a problem that does not say what holds beyond a surface is asked for it, and --contact answers") {
  const Workspace workspace;
  run_to_contact(workspace, oscillator(spring, ""));
  check_refused(workspace.tchat(born), {"contact with event 1 (touch) would change nothing", "no index jump function",
                                        "--contact FIELD,EVENT,JUMP"});
  check_refused(workspace.tchat(born + "--contact 3,2,1"), {"--contact: there is no field 3, problem Stop has 2"});
  check_refused(workspace.tchat(born + "--contact 2,9,1"), {"--contact: there is no event function 9"});
  check_refused(workspace.tchat(born + "--contact 2,2,9"), {"--contact: there is no jump 9"});
  check_refused(workspace.tchat(born + "--contact 2,2"), {"--contact '2,2': index vector 1 has 2 numbers"});
  check_refused(workspace.tchat(born + "--contact 2,2,1;1,1,1"), {"--contact is one index vector", "2 were given"});
  check_refused(workspace.tchat(born + "--contact 2,1,1"),
                {"the contact cannot end in event 1 (touch)", "name an event function of the other sign"});
  check_refused(workspace.tchat(born + "--contact 2,2,1 --signature 1,1,1;2,2,1"),
                {"--contact and --signature both say what follows the contact"});
  check_refused(workspace.tchat("resegment q.free GR1 --to grazing-curve --contact 2,2,1 -o born -p stop"),
                {"--contact goes with --to impacting"});
  const Outcome given = workspace.tchat(born + "--contact 2,2,1 NMX=20");
  INFO(given.text());
  REQUIRE(given.status == 0);
  const Outcome run = workspace.tchat("run stop -c born -s born -o contact");
  INFO(run.text());
  REQUIRE(run.status == 0);
  CHECK_FALSE(contains(run.out, "inadmissible"));
  const PointSection branch = workspace.points("contact").front();
  CHECK(std::abs(branch.rows.front().values[branch.column("A")] - grazing()) < 1e-9);
}

TEST_CASE("contacts that begin no branch of short contacts are refused with the reason") {
  const Workspace workspace;
  run_to_contact(workspace, oscillator(spring, follows));
  const auto refused = [&](const std::string& beyond, const std::vector<std::string>& words) {
    workspace.write("other.tch", oscillator(beyond, follows));
    check_refused(workspace.tchat("resegment q.free GR1 --to impacting -o born -p other"), words);
  };
  refused("x' = v - 1\nv' = force", {"no orbit with a short contact with event 1 (touch) begins here",
                                     "leads back to it at once (h_x f = 1, not 0)", "slide"});
  refused("x' = v + 1\nv' = force", {"leads away from it (h_x f = -1, not 0)", "tchat simulate"});
  refused("x' = v\nv' = force + 10", {"curves away from it (h'' = -3.75, not > 0)", "tchat simulate"});
}

TEST_CASE("a lost contact is joined over any section, with coarse tolerances too, and GRSTOP=0 goes on inadmissibly") {
  const Workspace workspace;
  run_to_contact(workspace, oscillator(spring, follows));
  REQUIRE(workspace.tchat(born + "NMX=8").status == 0);
  REQUIRE(workspace.tchat("run stop -c born -s born -o contact").status == 0);
  const std::string back = "run stop -c r.contact -s contact IRS=EP1 NMX=40 ";
  const auto arrive = [&](const std::string& more) {
    for (const std::string ds : {"DS=-0.05 ", "DS=0.05 "}) {
      const Outcome run = workspace.tchat(back + ds + more);
      INFO(run.text());
      REQUIRE(run.status == 0);
      if (contains(run.out, "  GR label")) return run;
    }
    FAIL("no GR label");
    return Outcome{};
  };
  const Outcome exact = arrive("-o back");
  CHECK(contains(exact.out, "the contact after event 1 (touch) of segment 1, has"));
  CHECK(contains(exact.out, "stopped: at the grazing point above"));

  for (const std::string section : {"", "--signature 1,3,1", "--signature 1,4,1"}) {
    INFO(section);
    const Outcome joined = workspace.tchat("resegment q.back GR1 --to signature -o joined -p stop NMX=5 " + section);
    INFO(joined.text());
    REQUIRE(joined.status == 0);
    const Outcome run = workspace.tchat("run stop -c joined -s joined -o free_again");
    INFO(run.text());
    REQUIRE(run.status == 0);
    CHECK_FALSE(contains(run.out, "inadmissible"));
    const SolutionEntry end = workspace.solutions("free_again").back();
    CHECK(end.parameter(1) < grazing());
    double largest = 0.0;  // of x, the last state, which is the sine of amplitude A / |...|
    for (const std::vector<double>& state : end.states) largest = std::max(largest, std::abs(state[3]));
    CHECK(std::abs(largest - end.parameter(1) / grazing()) < 2e-3);
  }
  check_refused(workspace.tchat("resegment q.back GR1 --to signature --signature 1,9,1 -o joined -p stop"),
                {"--signature: problem Stop has 4 event functions, there is no 9"});
  check_refused(workspace.tchat("resegment q.back GR1 --to signature --signature 1,2,1 -o joined -p stop"),
                {"event 2 (leave) does not fall through zero along the orbit"});

  arrive("-o coarse EPSS=1e-4 EPSL=1e-5 EPSU=1e-5");
  const Outcome coarse = workspace.tchat("resegment q.coarse GR1 --to signature -o joined -p stop NMX=5");
  INFO(coarse.text());
  CHECK(coarse.status == 0);

  const Outcome beyond = arrive("-o beyond GRSTOP=0");
  CHECK(contains(beyond.out, "inadmissible"));
  CHECK(contains(beyond.out, "negative duration"));
}

TEST_CASE("two stops: contacts that begin at once are refused, on the way back both are lost") {
  const Workspace workspace;
  workspace.write("two.tch", R"(
par A=3, w=2.5, z=0.05, k=4, g=1
init x=0, v=0, s=0, c=1
x' = v
force = A*c - 2*z*v - x
s' = (1-s^2-c^2)*s + w*c
c' = (1-s^2-c^2)*c - w*s
field free
v' = force
field right
v' = force - k*(x-g)
field left
v' = force - k*(x+g)
event touch_r = g - x
event leave_r = x - g
event touch_l = x + g
event leave_l = -g - x
event top = v
after touch_r: right until leave_r -> identity
after touch_l: left until leave_l -> identity
after any: free until touch_r -> identity, touch_l -> identity, top -> identity
)");
  REQUIRE(workspace.tchat("simulate two --dat free").status == 0);
  REQUIRE(workspace.tchat("run two -c free -d free -o free DS=0.05 DSMAX=0.5 RL1=30").status == 0);
  check_refused(workspace.tchat("resegment q.free GR1 --to impacting -o born -p two"),
                {"2 contacts begin here at once", "tchat simulate NAME --dat O"});
  REQUIRE(workspace.tchat("simulate two PAR(A)=5.33 --without-sections --dat hit").status == 0);
  const Outcome back = workspace.tchat("run two -c hit -d hit -o back DS=-0.02 NMX=100 DSMAX=0.1");
  INFO(back.text());
  REQUIRE(back.status == 0);
  const std::vector<SolutionEntry> labels = workspace.solutions("back");
  CHECK(std::abs(labels.back().parameter(1) - grazing()) < 1e-7);
  const Outcome joined = workspace.tchat("resegment q.back GR1 --to signature -o joined -p two NMX=5");
  INFO(joined.text());
  REQUIRE(joined.status == 0);
  CHECK(contains(joined.out, "-> {(1,5,1)}"));
  const Outcome run = workspace.tchat("run two -c joined -s joined -o joined");
  INFO(run.text());
  CHECK(run.status == 0);
  CHECK_FALSE(contains(run.out, "inadmissible"));
}

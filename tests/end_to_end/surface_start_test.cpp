// Where a simulation begins whose start lies on the surface of an event: before the event or after it.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/event_list.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Outcome tchat(const Workspace& workspace, const std::string& arguments) {
  Outcome outcome = workspace.tchat(arguments);
  INFO("tchat " << arguments << "\n" << outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome;
}

std::vector<ListedEvent> events_of(const Workspace& workspace, const std::string& name, std::size_t n) {
  return read_event_list(workspace.read(name + ".events"), n);
}

/// The simplest walker (Garcia, Chatterjee, Ruina, Coleman, J. Biomech. Eng. 120, 1998). It starts just after a heel
/// strike, where the event function is zero and falls; the printed gait has theta = 0.2003, theta' = -0.1998.
const char* const walker = R"(par gamma=0.009
init th=0.2003, w=-0.19983, ph=0.4006, p=-0.01578
a = sin(th - gamma)
th' = w
w' = a
ph' = p
p' = a + w^2*sin(ph) - cos(th - gamma)*sin(ph)
event strike = 2*th - ph
jump step: th -> -th, w -> cos(2*th)*w, ph -> -2*th, p -> cos(2*th)*(1 - cos(2*th))*w
)";

const char* const successors = "after any: strike -> step\n";

/// A second event, halfway through the step, ends a segment; a state after it does not say so.
const char* const walker_in_halves = R"(par gamma=0.009
init th=0.2003, w=-0.19983, ph=0.4006, p=-0.01578
a = sin(th - gamma)
th' = w
w' = a
ph' = p
p' = a + w^2*sin(ph) - cos(th - gamma)*sin(ph)
event strike = 2*th - ph
event upright = th
jump identity: th -> th
jump step: th -> -th, w -> cos(2*th)*w, ph -> -2*th, p -> cos(2*th)*(1 - cos(2*th))*w
after strike: upright -> identity
after upright: strike -> step
after start: upright -> identity
)";

/// The phase is reset when it reaches 1.
const char* const clock_with_reset = R"(par a=1
init phase=1, y=0
phase' = 1
y' = a - y
event tick = 1 - phase
jump reset: phase -> 0, y -> y/2
after any: tick -> reset
)";

}  // namespace

TEST_CASE("simulate: a walker that starts just after a heel strike walks") {
  const Workspace workspace;
  workspace.write("walker.tch", std::string(walker) + successors);
  const Outcome after = tchat(workspace, "simulate walker");
  CHECK(contains(after.err, "the start is taken as the state after event 1 (strike)"));
  CHECK(contains(after.err, "--before-event"));
  CHECK(contains(after.out, "Periodic orbit, signature {(1,1,1)}"));
  CHECK(events_of(workspace, "walker", 4).front().time > 1.0);

  // Typed with four digits the state is a little behind the surface.
  const Outcome behind = tchat(workspace, "simulate walker --state 0.2003,-0.19983,0.40065,-0.01578");
  CHECK(contains(behind.err, "the start is taken as the state after event 1 (strike)"));
  CHECK(contains(behind.out, "Periodic orbit"));

  const Outcome before = tchat(workspace, "simulate walker --before-event --events 1");
  CHECK(before.err.empty());
  CHECK(events_of(workspace, "walker", 4).front().time == 0.0);
  CHECK(tchat(workspace, "simulate walker --after-event --events 1").err.empty());
  CHECK(contains(tchat(workspace, "simulate walker --after-event --state ph=0.1 --events 1").err,
                 "--after-event changes nothing"));
}

TEST_CASE("simulate: a start before an event that changes the field only is in the other field at once") {
  const Workspace workspace;
  workspace.write("stop.tch", R"(par k=4
init q=1, v=1
q' = v
field free: v' = -q
field in_contact: v' = -k*(q - 1)
event touch = 1 - q
event leave = q - 1
after touch: in_contact until leave -> identity
after any: free until touch -> identity
)");
  const Outcome outcome = tchat(workspace, "simulate stop --before-event --events 2");
  INFO(outcome.text());
  CHECK(outcome.err.empty());
  const std::vector<ListedEvent> events = events_of(workspace, "stop", 2);
  REQUIRE(events.size() >= 2);
  CHECK(events[0].time == 0.0);
  CHECK(events[1].time == Approx(std::acos(-1.0) / 2.0).epsilon(1e-9));  // half a period with the frequency sqrt(k)
}

TEST_CASE("simulate: from a label the motion is that of the label, and so are its durations") {
  const Workspace workspace;
  const auto [rule, segments, constants] =
      GENERATE(table<std::string, std::size_t, std::string>({{std::string(walker) + successors, 1, " -c gait"},
                                                             {std::string(walker) + successors, 1, ""},
                                                             {walker_in_halves, 2, " -c gait"}}));
  workspace.write("walker.tch", rule);
  tchat(workspace, "simulate walker --after-event --dat gait");
  tchat(workspace, "run walker -c gait -d gait -o branch RL0=0.008 RL1=0.0095 NMX=3");
  tchat(workspace, "verify q.branch -p walker -c gait");
  const auto solutions = workspace.solutions("branch");
  for (std::size_t label = 1; label <= solutions.size(); ++label) {
    tchat(workspace, "simulate walker" + constants + " -s branch -o again --events 4 IRS=" + std::to_string(label));
    double begin = 0.0;
    const auto events = events_of(workspace, "again", 4);
    REQUIRE(events.size() == 4);
    for (std::size_t i = 0; i < events.size(); ++i) {
      // The run's mesh error is below 1e-9, and the gait attracts.
      const double duration = solutions[label - 1].parameter(61 + static_cast<int>(i % segments));
      CHECK(events[i].time - begin == Approx(duration).margin(1e-7));
      begin = events[i].time;
    }
  }
  // Of the .dat that the simulation wrote likewise.
  tchat(workspace, "simulate walker" + constants + " -d gait -o again --events 1");
  CHECK(events_of(workspace, "again", 4).front().time > 1.0);
}

TEST_CASE("simulate: a clock that starts where it is reset is reset at once") {
  const Workspace workspace;
  workspace.write("ticking.tch", clock_with_reset);
  const Outcome at_once = tchat(workspace, "simulate ticking --events 2");
  CHECK(contains(at_once.err, "the start is taken as the state before event 1 (tick)"));
  CHECK(contains(at_once.err, "--after-event"));
  const auto events = events_of(workspace, "ticking", 2);
  REQUIRE(events.size() == 2);
  CHECK(events[0].time == 0.0);
  CHECK(events[1].time == Approx(1.0).epsilon(1e-9));
  tchat(workspace, "simulate ticking --after-event --time 3");
  CHECK(events_of(workspace, "ticking", 2).empty());
}

TEST_CASE("sweep: starts behind a wall are counted, and those on a surface take the side that simulate takes") {
  const Workspace workspace;
  const Outcome behind = tchat(workspace, "sweep linosc --over x1=0.5:1.5:5 -o basin");
  CHECK(contains(behind.err, "2 of 5 starts: the start is behind event 1 (wall); its function is -0.5 to -0.25 there"));
  CHECK(tchat(workspace, "sweep linosc --over x1=0.25:0.5:2 -o free").err.empty());
  // Neighbours are followed from the first value alone.
  CHECK(contains(tchat(workspace, "sweep linosc --over alpha=2.9:3:3 --follow up --state x1=1.5 -o up").err,
                 "1 of 1 starts: the start is behind event 1 (wall)"));

  workspace.write("walker.tch", std::string(walker) + successors);
  const Outcome walks = tchat(workspace, "sweep walker --over gamma=0.0085:0.009:2 --transient-events 100");
  CHECK(contains(walks.err, "2 of 2 starts: the start is taken as the state after event 1 (strike)"));
  CHECK(contains(walks.out, "periodic, {(1,1,1)}, 2 times"));
}

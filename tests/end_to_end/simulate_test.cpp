// tchat simulate: the files it writes, orbits that tchat run goes on with, exit statuses, Ctrl-C.
#include <signal.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <thread>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/event_list.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

Outcome simulate(const Workspace& workspace, const std::string& arguments, int status = 0) {
  Outcome outcome = workspace.tchat("simulate " + arguments);
  INFO("tchat simulate " << arguments << "\n" << outcome.text());
  CHECK(outcome.signal == 0);
  REQUIRE(outcome.status == status);
  return outcome;
}

const std::string logistic_clock = R"(#include <tchat/problem.hpp>
struct LogisticClock {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  static constexpr const char* parameter_names[] = {"a"};
  static constexpr double initial_parameters[] = {3.566};
  static constexpr double initial_state[] = {0.0, 0.4};
  template <class T> void field(int, const T*, const T*, T* f) const { f[0] = T(1.0), f[1] = T(0.0); }
  template <class T> T event(int, const T* x, const T*) const { return 1.0 - x[0]; }
  template <class T> void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0] - 1.0, g[1] = p[0] * x[1] * (1.0 - x[1]);
  }
};
TCHAT_PROBLEM(LogisticClock)
)";

const std::string ball = R"(#include <tchat/problem.hpp>
struct Ball {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  static constexpr const char* state_names[] = {"height", "velocity"};
  static constexpr const char* parameter_names[] = {"g", "r"};
  static constexpr double initial_parameters[] = {9.81, 0.5};
  static constexpr double initial_state[] = {2.0, 0.0};
  template <class T> void field(int, const T* x, const T* p, T* f) const { f[0] = x[1], f[1] = -p[0]; }
  template <class T> T event(int, const T* x, const T*) const { return x[0]; }
  template <class T> void jump(int, const T* x, const T* p, T* g) const { g[0] = x[0], g[1] = -p[1] * x[1]; }
};
TCHAT_PROBLEM(Ball)
)";

/// x'' = a cos 2t - x - 0.1 x' under a wall at x = 1, and a stroboscopic section where the phase passes pi.
const std::string driven = R"(#include <tchat/problem.hpp>
struct Driven {
  static constexpr int dimension = 4, parameters = 1, fields = 1, events = 2, jumps = 2;
  static constexpr const char* state_names[] = {"x", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"a"};
  static constexpr const char* event_names[] = {"wall", "phase pi"};
  static constexpr double initial_parameters[] = {4.0};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 1.0};
  template <class T> void field(int, const T* x, const T* p, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1], f[1] = p[0] * x[3] - x[0] - 0.1 * x[1];
    f[2] = growth * x[2] + 2.0 * x[3], f[3] = growth * x[3] - 2.0 * x[2];
  }
  template <class T> T event(int j, const T* x, const T*) const { return j == 1 ? T(1.0 - x[0]) : x[2]; }
  template <class T> void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 2) g[1] = -0.8 * x[1];
  }
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 2}, {1, 2, 1}}; }
};
TCHAT_PROBLEM(Driven)
)";

/// Segment numbers of the rows of a trajectory, each once.
std::vector<long> segments_of(const std::string& trajectory) {
  std::vector<long> segments;
  std::istringstream rows(trajectory);
  for (std::string line; std::getline(rows, line);) {
    if (line.empty() || line[0] == '#') continue;
    const long segment = std::stol(line);
    if (segments.empty() || segments.back() != segment) segments.push_back(segment);
  }
  return segments;
}

}  // namespace

TEST_CASE("simulate: without any option, from the problem's start to its orbit") {
  const Workspace workspace;
  const Outcome outcome = simulate(workspace, "linosc");
  CHECK(outcome.err.empty());
  CHECK(contains(outcome.out, "Periodic orbit, signature {(1,2,2)}, period 3.14159265359"));
  CHECK(contains(outcome.out, "stable"));
  CHECK(contains(outcome.out, "Written: linosc.trajectory, linosc.events"));
  CHECK_FALSE(workspace.has("linosc.dat"));

  const auto events = read_event_list(workspace.read("linosc.events"), 4);
  REQUIRE(events.size() > 10);
  for (const ListedEvent& e : events) {
    CHECK(e.field == 1);
    if (e.what != "event") continue;
    CHECK(std::abs(e.h) < 1e-11);
    CHECK(e.rate < 0.0);
    CHECK(e.before[0] <= 1.0 + 1e-11);
    if (e.event == 1) CHECK(e.after[1] == Approx(-0.8 * e.before[1]));
    if (e.event == 2) CHECK(e.after == e.before);
  }
  // From the orbit in closed form, and no number of this program.
  CHECK(events.back().before[0] == Approx(0.997785157856609).margin(1e-5));

  std::istringstream rows(workspace.read("linosc.trajectory"));
  double time = -1.0;
  int count = 0;
  for (std::string line; std::getline(rows, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> words = words_of(line);
    REQUIRE(words.size() == 9);
    CHECK(std::stod(words[4]) >= time);
    time = std::stod(words[4]);
    CHECK(std::stod(words[5]) <= 1.0 + 1e-9);
    ++count;
  }
  CHECK(count > 1000);
}

TEST_CASE("simulate: two equal runs write the same bytes, and keep what was there before") {
  const Workspace workspace;
  const std::string run = "linosc PAR(alpha)=3.2 PAR(omega)=2.0072 --events 1 --dat found";
  simulate(workspace, run + " -o a", 1);
  CHECK_FALSE(workspace.has("found.dat"));
  const std::string orbit = "linosc PAR(alpha)=3.0485 PAR(omega)=2.0072 --dat found -o ";
  const Outcome first = simulate(workspace, orbit + "a");
  for (const char* name : {"a.trajectory~", "a.events~"}) CHECK(workspace.has(name));
  const Outcome second = simulate(workspace, orbit + "b");
  CHECK(workspace.read("a.trajectory") == workspace.read("b.trajectory"));
  CHECK(workspace.read("a.events") == workspace.read("b.events"));
  CHECK(workspace.read("found.dat") == workspace.read("found.dat~"));
  CHECK(workspace.read("gc.found") == workspace.read("gc.found~"));
  CHECK(first.out.substr(0, first.out.find("Written")) == second.out.substr(0, second.out.find("Written")));
  CHECK_FALSE(workspace.has_unfinished());
}

TEST_CASE("simulate: the orbit's own constants file keeps what the given one says") {
  const Workspace workspace;
  simulate(workspace, "linosc -c impacting -d impacting --dat found -o trial NTST=33 DSMAX=0.07 --free omega");
  const std::string constants = workspace.read("gc.found");
  for (const char* line : {"NTST = 33 ", "DSMAX = 0.07 ", "ICP = [2, 61] ", "GCHIND = [1] ", "IRS = 0 "}) {
    INFO(constants);
    CHECK(contains(constants, line));
  }
  workspace.run("-c found -d found -o onward NMX=3");
}

TEST_CASE("simulate: a start from a label of an earlier run, on both sides of its period doubling") {
  const Workspace workspace;
  workspace.run("-c to_grazing -d nonimpacting -o grazing");
  workspace.run("-c grazing_curve -s grazing -o grazing_curve --both");
  workspace.run("-c impacting_20072 -s grazing_curve -o impacting");
  // Closed form: period doubling at alpha = 3.03619356554716, the doubled orbit lives below it.
  const Outcome above = simulate(workspace, "linosc -c impacting_20072 -s impacting IRS=PD1 PAR(alpha)=3.038 -o above");
  CHECK(contains(above.out, "signature {(1,1,1)}"));
  const Outcome below =
      simulate(workspace, "linosc -c impacting_20072 -s impacting IRS=PD1 PAR(alpha)=3.0361 -o below --dat doubled");
  CHECK(contains(below.out, "signature {(1,1,1)}^2"));
  CHECK(contains(below.out, ": stable"));
  workspace.run("-c doubled -d doubled -o doubled NMX=3");
}

TEST_CASE("simulate: an orbit of 16 events is recognised and continued, a longer one when asked for") {
  const Workspace workspace;
  workspace.write("logistic.cpp", logistic_clock);
  const Outcome outcome = simulate(workspace, "logistic --transient-time 20000 --recognition 1e-8 --rows 2 --dat");
  CHECK(contains(outcome.out, "period 16\n"));
  CHECK(contains(outcome.out, "segment 16: (1,1,1)"));
  const Outcome run = workspace.tchat("run logistic -d logistic NMX=2");
  INFO(run.text());
  CHECK(run.status == 0);
  const std::string diagnostics = workspace.read("d.logistic");
  CHECK(number_after(diagnostics, "Iterations   :") <= 4);

  const std::string longer = "logistic PAR(a)=3.569 --transient-time 100000 --recognition 1e-8 --rows 0 --events 200 ";
  CHECK(contains(simulate(workspace, longer + "-o x").out, "No periodic orbit recognised"));
  CHECK(contains(simulate(workspace, longer + "-o x --max-period 32").out, "period 32\n"));
}

TEST_CASE("simulate: walls are monitored on the orbit handed over, sections are not") {
  const Workspace workspace;
  workspace.write("driven.cpp", driven);
  const Outcome outcome = simulate(workspace, "driven --rows 0 --dat");
  CHECK(contains(outcome.out, "signature {(1,1,2), (1,2,1)}"));
  const std::string constants = workspace.read("gc.driven");
  INFO(constants);
  for (const char* line : {"GCHGRZIND = [[1], [1]] ", "GCIPSI = [1, 2] ", "GRJUMP = 2 ", "NPR = 0 "})
    CHECK(contains(constants, line));
  // A GRJUMP that is given stays, where the problem has such a jump.
  check_refused(workspace.tchat("simulate driven GRJUMP=3 --dat other -q"), {"GRJUMP is 3", "allowed: 1..2"});
  std::string with_another_jump = driven;
  with_another_jump.replace(with_another_jump.find("jumps = 2"), 9, "jumps = 3");
  workspace.write("driven.cpp", with_another_jump);
  simulate(workspace, "driven GRJUMP=3 --dat other -q");
  CHECK(contains(workspace.read("gc.other"), "GRJUMP = 3 "));
}

TEST_CASE(
    "simulate: an event after which another field may follow is no section, whatever follows where it is nearest") {
  std::string problem = driven;
  const auto put = [&](const std::string& old, const std::string& text) {
    REQUIRE(contains(problem, old));
    problem.replace(problem.find(old), old.size(), text);
  };
  put("fields = 1, events = 2", "fields = 2, events = 3");
  put("\"phase pi\"", "\"phase pi\", \"far left\"");
  put("return j == 1 ?", "return j == 3 ? T(99.0 + x[0]) : j == 1 ?");
  put("std::array<int, 3>) const { return {{1, 1, 2}, {1, 2, 1}}; }",
      "std::array<int, 3> from, const double* x, const double*) const {\n"
      "    if (from[1] == 3 && x[0] > 0.0) return {{2, 1, 2}};\n"
      "    return {{1, 1, 2}, {1, 2, 1}, {1, 3, 1}};\n  }");
  const Workspace workspace;
  workspace.write("driven.cpp", problem);
  simulate(workspace, "driven --rows 0 -q --dat");
  const std::string constants = workspace.read("gc.driven");
  INFO(constants);
  CHECK(contains(constants, "GCHGRZIND = [[1, 3], [1, 3]] "));
}

TEST_CASE("simulate: an orbit without its section, where it has another event") {
  const Workspace workspace;
  workspace.write("driven.cpp", driven);
  const Outcome both = simulate(workspace, "driven --dat both");
  const Outcome one = simulate(workspace, "driven --dat one --without-sections");
  CHECK(contains(both.out, "signature {(1,1,2), (1,2,1)}, period 3.14159265359"));
  CHECK(contains(one.out, "signature {(1,1,2)}, period 3.14159265359"));
  const auto multipliers = [](const Outcome& o) { return o.out.substr(o.out.find("multipliers"), 30); };
  CHECK(multipliers(one) == multipliers(both));
  CHECK(contains(workspace.read("gc.one"), "GCHGRZIND = [[1]] "));
  workspace.run("-c one -d one -p driven -o first NMX=3");
  CHECK(contains(workspace.read("d.first"), "Iterations   :"));
}

TEST_CASE("simulate: data of a signature can start another one") {
  const Workspace workspace;
  workspace.write("driven.cpp", driven);
  simulate(workspace, "driven --dat two -o driven");
  const Outcome one = simulate(workspace, "driven -c two -d two --signature 1,1,2 -o one --dat one");
  CHECK(contains(one.out, "first row of two.dat"));
  CHECK(contains(one.out, "signature {(1,1,2)}, period 3.14159265359"));
  check_refused(workspace.tchat("simulate driven -d two --signature 1,1,2"), {"two.dat"});
}

TEST_CASE(
    "simulate: the end of a long motion is kept, all of it when a length is asked for, and large files are told") {
  const Workspace workspace;
  workspace.write("logistic.cpp", logistic_clock);
  const Outcome outcome = simulate(workspace, "logistic PAR(a)=3.9");  // chaotic
  const std::vector<long> last = segments_of(workspace.read("logistic.trajectory"));
  REQUIRE(last.size() > 100);
  CHECK(last.size() < 10'000);
  CHECK(last.back() == 10'000);
  CHECK(last.front() == 10'001 - static_cast<long>(last.size()));
  CHECK(contains(outcome.out, "holds the last " + std::to_string(last.size()) + " of 10000 segments"));
  CHECK(contains(outcome.out, "Written: logistic.trajectory, logistic.events"));
  const std::size_t size = workspace.read("logistic.trajectory").size();
  CHECK(size > 9'000'000);
  CHECK(size <= 10'000'000);
  CHECK(read_event_list(workspace.read("logistic.events"), 2).size() == 10'000);

  const Outcome all = simulate(workspace, "logistic PAR(a)=3.9 --events 10000");
  const std::string trajectory = workspace.read("logistic.trajectory");
  CHECK(segments_of(trajectory).size() == 10'000);
  const std::size_t megabytes = (trajectory.size() + 500'000) / 1'000'000;
  CHECK(contains(all.out, "Written: logistic.trajectory (" + std::to_string(megabytes) + " MB), logistic.events\n"));
}

TEST_CASE("simulate: --refine finds orbits that attract nothing, beside the logistic map's closed forms") {
  const Workspace workspace;
  workspace.write("logistic.cpp", logistic_clock);
  constexpr double a = 3.9;
  const auto start_of = [](const Outcome& outcome) { return number_after(outcome.out, "U(2) = "); };
  const auto multiplier_of = [](const Outcome& outcome) { return number_after(outcome.out, "multipliers "); };

  // x = 1 - 1 / a, with the multiplier 2 - a.
  const Outcome fixed = simulate(workspace, "logistic PAR(a)=3.9 --state 0,0.74 --refine --dat fixed");
  CHECK(contains(fixed.out, "signature {(1,1,1)}, period 1\n"));
  CHECK(start_of(fixed) == Approx(1.0 - 1.0 / a).epsilon(1e-12));
  CHECK(multiplier_of(fixed) == Approx(2.0 - a).epsilon(1e-9));
  CHECK(contains(fixed.out, "not stable"));

  // a^2 x^2 - a (a + 1) x + a + 1 = 0, with the multiplier 4 + 2 a - a^2.
  const Outcome two = simulate(workspace, "logistic PAR(a)=3.9 --state 0,0.9 --refine --events 2 --dat two");
  const double x = start_of(two);
  CHECK(std::abs(a * a * x * x - a * (a + 1.0) * x + a + 1.0) < 1e-11);
  CHECK(multiplier_of(two) == Approx(4.0 + 2.0 * a - a * a).epsilon(1e-8));
  // Both are what a run starts from.
  for (const std::string name : {"fixed", "two"}) {
    const Outcome run = workspace.tchat("run logistic -c " + name + " -d " + name + " -o " + name + " NMX=5");
    CHECK(run.status == 0);
    CHECK(contains(run.out, "0 stable"));
  }
  // What the first row of a file says, and what is no period.
  workspace.write("table.dat", "# PAR(a) = 3.9\n0 0 0.74\n0.5 0.5 0.74\n1 1 0.74\n");
  CHECK(start_of(simulate(workspace, "logistic -d table --refine")) == Approx(1.0 - 1.0 / a).epsilon(1e-12));
  workspace.write("driven.cpp", driven);
  const Outcome none = simulate(workspace, "driven --refine --max-period 1 --dat none", 1);
  CHECK(contains(none.out, "Nothing to refine: the first event is not met again within 1 event (--max-period)."));
  CHECK_FALSE(workspace.has("none.dat"));
  CHECK(contains(simulate(workspace, "logistic --refine --lyapunov", 2).err, "excludes"));
}

TEST_CASE("simulate: a watched event that is never positive is named where none is met") {
  const Workspace workspace;
  workspace.write("fall.tch",
                  "x' = v\nv' = -1\nevent floor = x\nevent ceiling = 1 - x\njump hit: v -> -0.5*v\n"
                  "after any: floor -> hit, ceiling -> hit\n");
  const Outcome resting = workspace.tchat("simulate fall --events 3");
  CHECK(contains(resting.out, "not positive when the segment begins: event 1 (floor). An event"));
  const Outcome rising = workspace.tchat("simulate fall --events 3 --state 0.5,-1 --signature 1,2,1 --wait 0.1");
  INFO(rising.text());
  CHECK(contains(rising.out, "no event within 0.1 time units"));
  CHECK_FALSE(contains(rising.out, "not positive"));
}

TEST_CASE("simulate: chattering is told with its limit in time, no orbit is written") {
  const Workspace workspace;
  workspace.write("ball.cpp", ball);
  const Outcome outcome = simulate(workspace, "ball --dat", 1);
  CHECK(contains(outcome.out, "Events accumulate (chattering)"));
  CHECK(contains(outcome.err, "no periodic orbit was found"));
  const double first = std::sqrt(2.0 * 2.0 / 9.81);
  CHECK(number_after(outcome.out, "The limit is at t = ") == Approx(3.0 * first).epsilon(1e-9));
  CHECK_FALSE(workspace.has("ball.dat"));
  CHECK_FALSE(workspace.has("gc.ball"));
  CHECK(simulate(workspace, "ball").status == 0);
  // At rest on the floor.
  CHECK(contains(simulate(workspace, "ball PAR(r)=0").out, "the contact lasts"));
}

/// x' = v, v' = -p x, with another p on the other side of x = 0. Begins with (1,1,1).
const char* const switching = R"(#include <tchat/problem.hpp>
#include <array>
#include <vector>
struct Switching {
  static constexpr int dimension = 2, parameters = 1, fields = 2, events = 2, jumps = 1;
  static constexpr double initial_parameters[] = {1.0};
  template <class T> void field(int i, const T* x, const T* par, T* f) const { f[0] = x[1], f[1] = -i * par[0] * x[0]; }
  template <class T> T event(int j, const T* x, const T*) const { return j == 1 ? x[0] : -x[0]; }
  template <class T> void jump(int, const T* x, const T*, T* g) const { g[0] = x[0], g[1] = x[1]; }
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[0] == 1) return {{2, 2, 1}};
    return {{1, 1, 1}};
  }
};
TCHAT_PROBLEM(Switching)
)";

TEST_CASE("simulate: a start on a switching surface that the motion leaves to the wrong side is told") {
  const Workspace workspace;
  workspace.write("switching.cpp", switching);
  CHECK(contains(simulate(workspace, "switching --state 0,-1 --events 1").err, "the start lies on event 1"));
  CHECK(contains(simulate(workspace, "switching --state -1,-1 --events 1").err, "the start is behind event 1"));
  CHECK(simulate(workspace, "switching --state 0,1 --events 1").err.empty());
  CHECK(simulate(workspace, "switching --state 1,-1 --events 1").err.empty());
}

TEST_CASE("simulate: several events at once, a start beyond a wall, rest and near-grazing contacts are told") {
  const Workspace workspace;
  const Outcome beyond = simulate(workspace, "linosc --state x1=1.5 --events 3");
  CHECK(contains(beyond.out, "beyond a wall"));
  CHECK(contains(beyond.err, "the start is behind event 1 (wall): its function is -0.5 there"));
  // At rest, where the jump does not show that it is a wall; the section may be negative.
  const Outcome still = simulate(workspace, "linosc --state x1=1.5,x2=0,y1=1,y2=0 --events 3");
  CHECK(contains(still.err, "--state"));
  CHECK(simulate(workspace, "linosc --state x1=-0.5,x2=0.1,y1=-1,y2=0 --events 3").err.empty());
  CHECK(simulate(workspace, "linosc --state x1=0.5,x2=0.1,y1=1,y2=0 --events 3").err.empty());
  const Outcome rest = simulate(workspace, "linosc PAR(alpha)=0 --state x1=0.5");
  CHECK(contains(rest.out, "The motion dies out"));
  const Outcome near = simulate(workspace, "linosc -c impacting PAR(alpha)=3.00666 PAR(omega)=2 --events 200");
  CHECK(contains(near.out, "near-grazing contact"));
  int contacts = 0;
  for (const ListedEvent& e : read_event_list(workspace.read("linosc.events"), 4)) {
    if (e.what != "contact") continue;
    ++contacts;
    CHECK(e.event == 1);
    CHECK(e.jump == 0);
    CHECK(e.h > 0.0);
    CHECK(std::abs(e.before[1]) < 1e-8);
    CHECK(e.after == e.before);
  }
  CHECK(contacts > 0);
}

TEST_CASE("simulate: a signature followed without the index jump function, and what contradicts it") {
  const Workspace workspace;
  const Outcome maxima = simulate(workspace, "linosc --signature 1,3,2 PAR(alpha)=2 --dat minima -o m");
  CHECK(contains(maxima.out, "signature {(1,3,2)}, period 3.14159265359"));
  workspace.run("-c minima -d minima -o minima NMX=2");
  // Beyond grazing the smooth orbit crosses the wall: what a signature watches says gc.C, else the index jump function.
  const Outcome alone = simulate(workspace, "linosc --signature 1,3,2 PAR(alpha)=3.2 PAR(omega)=2 -o c");
  CHECK(contains(alone.out, "a monitored event function fell below zero, first event 1 (wall)"));
  CHECK(contains(alone.out, "Without a signature to follow"));
  const Outcome crossing =
      simulate(workspace, "linosc -c nonimpacting_alpha --follow-signature PAR(alpha)=3.2 PAR(omega)=2 -o c");
  CHECK(contains(crossing.out, "a monitored event function fell below zero, first event 1 (wall)"));
  bool is_listed = false;
  for (const ListedEvent& e : read_event_list(workspace.read("c.events"), 4)) is_listed |= e.what == "violation";
  CHECK(is_listed);
}

TEST_CASE("simulate: a trajectory is plotted, in time or as a phase portrait, with the problem's names") {
  const Workspace workspace;
  simulate(workspace, "linosc --time 20");
  const Outcome series = workspace.tchat("plot linosc.trajectory -p linosc -y x1,y2 --script series.gp -o series.png");
  INFO(series.text());
  CHECK(series.status == 0);
  CHECK(workspace.has("series.png"));
  const std::string script = workspace.read("series.gp");
  for (const char* part : {"time", "wall", "x", "y"}) CHECK(contains(script, part));
  CHECK(workspace.tchat("plot linosc -x x1 -y x2 -o portrait.svg").status == 0);
  CHECK(contains(workspace.read("portrait.svg"), "<svg"));

  simulate(workspace, "linosc --time 20 --rows 0 -o empty");
  check_refused(workspace.tchat("plot empty.trajectory -o x.png"), {"empty.trajectory", "--rows"});
  check_refused(workspace.tchat("plot linosc.events -o x.png"), {"linosc.events", "trajectory"});
  check_refused(workspace.tchat("plot linosc.trajectory 3 -o x.png"), {"no labels"});
  check_refused(workspace.tchat("plot linosc.trajectory -y z -o x.png"), {"'z'", "x1, x2, y1, y2"});
  workspace.write("broken.trajectory", "# X with a = 1\n#segment i j k t x\n1 1 1 1 0 0\n1 1 1 1 0\n");
  check_refused(workspace.tchat("plot broken.trajectory -o x.png"), {"broken.trajectory:4", "5 numbers"});
}

TEST_CASE("simulate: -q is silent") {
  const Workspace workspace;
  const Outcome outcome = simulate(workspace, "linosc -q --dat found");
  CHECK(outcome.text().empty());
  CHECK(workspace.has("found.dat"));
}

namespace {

/// What o.events is to become, .o.events.XXXXXX.new; "" without such a file.
std::string unfinished_events(const Workspace& workspace) {
  for (const auto& entry : std::filesystem::directory_iterator(workspace.file("")))
    if (const std::string name = entry.path().filename(); name.starts_with(".o.events.") && name.ends_with(".new"))
      return workspace.read(name);
  return "";
}

}  // namespace

TEST_CASE("simulate: Ctrl-C and SIGTERM leave complete files") {
  for (const auto& [signal, status] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const Workspace workspace;
    simulate(workspace, "linosc --events 3 -o o");
    const std::string old = workspace.read("o.events");
    const auto process = workspace.start_tchat("simulate linosc PAR(alpha)=3.2 --time 1e9 --rows 2 -o o");
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (unfinished_events(workspace).size() < 100'000) {
      REQUIRE_FALSE(process->ended());
      REQUIRE(std::chrono::steady_clock::now() < deadline);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    CHECK(workspace.read("o.events") == old);  // until the new one is complete
    process->send(signal);
    const Outcome outcome = process->wait(std::chrono::seconds(30));
    CHECK_FALSE(outcome.timed_out);
    CHECK(outcome.status == status);
    CHECK(contains(outcome.out, "Interrupted."));
    CHECK(read_event_list(workspace.read("o.events"), 4).size() > 100);
    CHECK(workspace.read("o.events~") == old);
    CHECK(unfinished_events(workspace).empty());
    CHECK_FALSE(workspace.has(".o.trajectory.lock"));
  }
}

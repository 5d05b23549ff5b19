// The microactuator of section 2.2 as tchat simulate runs it: it steps forward under its drive; every event and every
// row of its trajectory obeys the laws of friction and impact, (2.42)-(2.46) with their errata corrected, evaluated
// here from the states listed alone; without its position it is the oscillator of problems/mems.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>
#include <tuple>

#include "end_to_end/event_list.hpp"
#include "published/chain.hpp"

using namespace test_support;
namespace fs = std::filesystem;

namespace {

constexpr double pi = 3.14159265358979323846;

// Section 5.3.2: m1 = 5, m2 = 1, k = 1, c = 0.04, d = 1, e = 0.8, mu_s = 0.4, mu_d = 0.27; N = (m1 + m2) 9.81.
constexpr double m1 = 5.0, m2 = 1.0, weight = (m1 + m2) * 9.81;
constexpr double holding = 0.4 * weight, sliding = 0.27 * weight, wall = 0.5, restitution = 0.8;
constexpr int stick = 1, slip_plus = 2, slip_minus = 3;

using State = std::vector<double>;  // p, u, q, q', sine, cosine

/// On the mass: electrostatic force less damper and spring. The frame feels its negative.
double force(const State& x, double voltage) {
  const double sine_squared = 0.5 * (1.0 - x[5]);  // of half the angle
  return voltage * voltage * sine_squared / ((1.0 - x[2]) * (1.0 - x[2])) - 0.04 * x[3] - x[2];
}

struct Row {
  long segment;
  int field;
  double time;
  State x;
};

std::vector<Row> read_trajectory(const std::string& text, std::size_t n) {
  std::vector<Row> rows;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> words = words_of(line);
    REQUIRE(words.size() == 5 + n);
    Row row{std::stol(words[0]), std::stoi(words[1]), std::stod(words[4]), {}};
    for (std::size_t k = 0; k < n; ++k) row.x.push_back(std::stod(words[5 + k]));
    rows.push_back(std::move(row));
  }
  return rows;
}

void copy_problems(const Workspace& workspace) {
  fs::copy_file(MICROACTUATOR_LIBRARY, workspace.file("microactuator.so"));
  fs::copy_file(MEMS_LIBRARY, workspace.file("mems.so"));
}

std::string simulate(const Workspace& workspace, std::vector<std::string> words) {
  words.insert(words.begin(), "simulate");
  const Outcome outcome = workspace.tchat(words);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome.out;
}

/// What must follow from a state of the frame at rest, from the balance of forces.
int field_from_rest(const State& x, double voltage) {
  const double on_frame = -force(x, voltage);
  if (std::abs(on_frame) < holding) return stick;
  return on_frame > 0.0 ? slip_plus : slip_minus;
}

/// The event itself, and the field that comes next.
void check_event(const ListedEvent& e, int next, double voltage) {
  CAPTURE(e.segment, e.field, e.event, e.jump, next);
  const State& before = e.before;
  CHECK(e.after[0] == before[0]);
  CHECK(e.after[2] == before[2]);
  if (e.event <= 2) {  // a stopper: momentum is kept, the relative velocity turns
    REQUIRE(e.jump == 1);
    CHECK(std::abs(before[2] - (e.event == 1 ? wall : -wall)) < 1e-10);
    CHECK((e.event == 1 ? before[3] : -before[3]) > -1e-12);
    CHECK(e.after[3] == Approx(-restitution * before[3]).epsilon(1e-12));
    const auto momentum = [](const State& x) { return (m1 + m2) * x[1] + m2 * x[3]; };
    CHECK(momentum(e.after) == Approx(momentum(before)).epsilon(1e-12).margin(1e-13));
    REQUIRE(std::abs(e.after[1]) > 0.0);
    CHECK(next == (e.after[1] > 0.0 ? slip_plus : slip_minus));
    return;
  }
  REQUIRE(e.jump == 2);
  CHECK(e.after == before);
  CHECK(std::abs(before[1]) < 1e-10);  // stick and the ends of slip
  if (e.event == 3 || e.event == 4) {  // static friction gives way
    CHECK(e.field == stick);
    CHECK(-force(before, voltage) == Approx(e.event == 3 ? holding : -holding).epsilon(1e-9));
    CHECK(next == (e.event == 3 ? slip_plus : slip_minus));
  } else {
    CHECK(e.field == (e.event == 5 ? slip_plus : slip_minus));
    CHECK(next == field_from_rest(before, voltage));
  }
}

/// Between events: stick only under forces that friction holds, slip only in its own direction.
void check_row(const Row& row, double voltage) {
  CAPTURE(row.segment, row.field, row.time);
  CHECK(std::abs(row.x[2]) <= wall + 1e-9);
  if (row.field == stick) {
    CHECK(std::abs(row.x[1]) < 1e-10);
    CHECK(std::abs(force(row.x, voltage)) <= holding * (1.0 + 1e-9));
  } else {
    CHECK((row.field == slip_plus ? row.x[1] : -row.x[1]) > -1e-10);
  }
}

/// In slip the two masses together feel sliding friction alone: their momentum falls at its rate, and its integral
/// gives the way of the frame. In stick the frame stays.
void check_segment(const Row& first, const Row& last) {
  CAPTURE(first.segment, first.field);
  const State &a = first.x, &b = last.x;
  const double t = last.time - first.time;
  if (first.field == stick) {
    CHECK(b[0] == a[0]);
    return;
  }
  const double friction = first.field == slip_plus ? -sliding : sliding;
  const double momentum = (m1 + m2) * a[1] + m2 * a[3];
  const double scale = 1.0 + std::abs(momentum);
  CHECK(std::abs((m1 + m2) * b[1] + m2 * b[3] - momentum - friction * t) < 1e-9 * scale);
  CHECK(std::abs((m1 + m2) * (b[0] - a[0]) + m2 * (b[2] - a[2]) - momentum * t - 0.5 * friction * t * t) <
        1e-9 * scale);
}

using Seen = std::set<std::tuple<int, int, int>>;

/// Simulates and checks all that is listed; the index vectors that occur.
Seen check_run(const Workspace& workspace, double voltage, const std::string& state, int events) {
  CAPTURE(voltage, state);
  std::vector<std::string> words{
      "microactuator", "PAR(V)=" + std::to_string(voltage), "--events", std::to_string(events), "--wait", "30"};
  if (!state.empty()) words.insert(words.end(), {"--state", state});
  simulate(workspace, words);
  const auto list = read_event_list(workspace.read("microactuator.events"), 6);
  const auto rows = read_trajectory(workspace.read("microactuator.trajectory"), 6);
  REQUIRE(list.size() > 1);
  Seen seen;
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (list[k].what != "event") continue;
    seen.insert({list[k].field, list[k].event, list[k].jump});
    const auto next =
        std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.segment > list[k].segment; });
    if (next != rows.end()) check_event(list[k], next->field, voltage);
  }
  for (const Row& row : rows) check_row(row, voltage);
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t last = first;
    while (last + 1 < rows.size() && rows[last + 1].segment == rows[first].segment) ++last;
    check_segment(rows[first], rows[last]);
    first = last + 1;
  }
  return seen;
}

double distance(const State& a, const State& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

State reduced(const State& x) { return {x.begin() + 1, x.end()}; }

}  // namespace

TEST_CASE("microactuator: stick, slip and impact obey friction, from rest and through all ten index vectors") {
  const Workspace workspace;
  copy_problems(workspace);
  Seen all;
  struct Run {
    double voltage;
    const char* state;
    int events;
  };
  for (const Run& run :
       {Run{0.79013593844, "", 60},           // J1, J7
        Run{0.7, "", 200}, Run{3.0, "", 40},  // strong enough to move the frame back before the first impact
        Run{0.3, "displacement=-0.4,velocity=-3", 10},
        Run{0.3, "displacement=-0.4,velocity=580", 40},  // the damper alone moves the frame
        Run{0.3, "frame velocity=-1,displacement=-0.4,velocity=-0.3", 6},
        Run{0.3, "frame velocity=-2,displacement=0.4,velocity=1", 8},
        Run{0.3, "frame velocity=2,displacement=-0.4,velocity=-0.5", 9}})
    all.merge(check_run(workspace, run.voltage, run.state, run.events));
  const Seen ten{{1, 1, 1}, {1, 2, 1}, {1, 3, 2}, {1, 4, 2}, {2, 1, 1},
                 {2, 2, 1}, {2, 5, 2}, {3, 1, 1}, {3, 2, 1}, {3, 6, 2}};
  CHECK(all == ten);
}

TEST_CASE("microactuator: from rest under its drive it steps forward") {
  const Workspace workspace;
  copy_problems(workspace);
  const std::string said = simulate(workspace, {"microactuator", "PAR(V)=0.79013593844", "PAR(omega)=0.8",
                                                "--tolerance", "1e-12", "--events", "200"});
  const auto list = read_event_list(workspace.read("microactuator.events"), 6);
  std::vector<double> steps, durations;
  double position = 0.0, time = 0.0;
  for (const ListedEvent& e : list) {
    if (e.what != "event" || e.event != 5) continue;
    steps.push_back(e.after[0] - position);
    durations.push_back(e.time - time);
    position = e.after[0];
    time = e.time;
  }
  REQUIRE(steps.size() > 90);
  CHECK(*std::min_element(steps.begin(), steps.end()) > 0.0);
  // By shooting: one step in each period of the drive, T2 = 0.071446681246 of slip.
  const double period = pi / 0.8;
  CHECK(durations.back() == Approx(period).epsilon(1e-10));
  CHECK(steps.back() == Approx(steps[steps.size() - 2]).epsilon(1e-9));
  CHECK(position > 90.0 * 0.99 * steps.back());
  const auto stated = said.find("frame position, which nothing depends on, advances by ");
  REQUIRE(stated != std::string::npos);
  CHECK(std::stod(said.substr(stated + 54)) == Approx(steps.back()).epsilon(1e-9));
  CHECK(said.find("signature {(1,1,1), (2,5,2)}, period 3.92699081698") != std::string::npos);

  // tchat run has no orbits that do not close.
  const Outcome refused = workspace.tchat("simulate microactuator --dat");
  CHECK(refused.status == 1);
  CHECK(refused.err.find("frame position does not return") != std::string::npos);
  CHECK_FALSE(workspace.has("microactuator.dat"));
}

TEST_CASE("microactuator: its reduced orbit is the one of mems that tchat run computes") {
  const Workspace workspace;
  copy_problems(workspace);
  for (const char* voltage : {"0.79013593844", "0.75"}) {
    CAPTURE(voltage);
    const std::string parameter = std::string("PAR(V)=") + voltage;
    simulate(workspace, {"mems", parameter, "--dat", "orbit"});
    const Outcome run = workspace.tchat("run mems -c orbit -d orbit -o orbit NMX=1 NTST=200 EPSL=1e-12 EPSU=1e-12");
    INFO(run.text());
    REQUIRE(run.status == 0);
    const SolutionEntry orbit = workspace.solutions("orbit").front();
    REQUIRE(orbit.states.front().size() == 10);
    const double t1 = orbit.parameter(61), t2 = orbit.parameter(62);
    if (std::string(voltage) == "0.79013593844") {  // by shooting
      CHECK(t1 == Approx(3.85554413574).epsilon(1e-10));
      CHECK(t2 == Approx(0.071446681246).epsilon(1e-9));
    }
    const auto part = [&](const State& x, int segment) {
      return State(x.begin() + 5 * segment, x.begin() + 5 * segment + 5);
    };

    simulate(workspace,
             {"microactuator", parameter, "--tolerance", "1e-13", "--events", "300", "--transient-events", "200"});
    const auto list = read_event_list(workspace.read("microactuator.events"), 6);
    const auto last = std::find_if(list.rbegin(), list.rend(), [](const auto& e) { return e.event == 5; });
    REQUIRE(last != list.rend());
    const ListedEvent& end = *last;
    const ListedEvent& impact = *std::next(last);
    const ListedEvent& start = *std::next(last, 2);
    REQUIRE(impact.event == 1);
    REQUIRE(start.event == 5);
    CHECK(std::abs(impact.time - start.time - t1) < 1e-8);
    CHECK(std::abs(end.time - impact.time - t2) < 1e-8);
    CHECK(distance(reduced(start.after), part(orbit.states.front(), 0)) < 1e-8);
    CHECK(distance(reduced(impact.before), part(orbit.states.back(), 0)) < 1e-8);
    CHECK(distance(reduced(impact.after), part(orbit.states.front(), 1)) < 1e-8);
    CHECK(distance(reduced(end.before), part(orbit.states.back(), 1)) < 1e-8);
  }
}

TEST_CASE("microactuator: its Makefile runs from a fresh copy") {
  const Workspace workspace;
  fs::create_directories(workspace.file("problems"));
  fs::copy(PROBLEMS "/microactuator", workspace.file("problems/microactuator"));
  const Outcome outcome = workspace.make("problems/microactuator", "OUT=" + workspace.file("out") + " all");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  for (const char* name : {"from_rest.events", "steady.trajectory", "strong_drive.events"})
    CHECK(workspace.has(std::string("out/") + name));
  CHECK(outcome.out.find("Events accumulate") != std::string::npos);
}

TEST_CASE("microactuator: from rest its motion is that of mems, event by event") {
  const Workspace workspace;
  copy_problems(workspace);
  for (const char* name : {"mems", "microactuator"})
    simulate(workspace, {name, "PAR(V)=0.79013593844", "--tolerance", "1e-13", "--events", "100"});
  // mems also cuts at maxima; impacts and ends of slip are the same.
  const auto of_both = [](const ListedEvent& e) { return e.what == "event" && e.jump != 3; };
  std::vector<ListedEvent> a, b;
  for (const ListedEvent& e : read_event_list(workspace.read("mems.events"), 5))
    if (of_both(e)) a.push_back(e);
  for (const ListedEvent& e : read_event_list(workspace.read("microactuator.events"), 6))
    if (of_both(e)) b.push_back(e);
  const std::size_t count = std::min(a.size(), b.size());
  REQUIRE(count > 60);
  for (std::size_t k = 0; k < count; ++k) {
    CHECK(std::abs(a[k].time - b[k].time) < 1e-8);
    CHECK(distance(a[k].after, reduced(b[k].after)) < 1e-8);
  }
}

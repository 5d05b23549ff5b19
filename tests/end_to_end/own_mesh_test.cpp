// OWNMESH=1: a segment with a sharp start beside a smooth one that may be a thousand times shorter. Durations in closed
// form, and restarts.
//
// Falling, x' = k (y - x) - x + k (x - y)^2 / 2 and y' = k (x - y)^2 / 2 - y, so that x - y = C exp(-(k + 1) t) = z and
// y = A exp(-t) + B z^2 / C^2 with B = -k C^2 / (4 k + 2), until x = a. Rising, both by q (2 - x) until x = b. Then x
// is thrown up by d, y down by e.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* source = R"(par k=20, q=1, a=0.5, b=1, d=1, e=0.02
init x=2, y=0.98
field fall: x' = k*(y-x) - x + k*(x-y)^2/2, y' = k*(x-y)^2/2 - y
field rise: x' = q*(2-x), y' = q*(2-y)
event low = x - a
event high = b - x
jump throw: x -> x+d, y -> y-e
jump identity: x -> x
after low: rise until high -> throw
after any: fall until low -> identity
)";

Outcome succeed(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  REQUIRE(outcome.status == 0);
  return outcome;
}

/// The time of the fall. x - y is C at its start, s = C exp(-(k + 1) T) at its end, 2 s / 3 after the rise, and so C is
/// 1.02 + 2 s / 3.
double fall_time(double k) {
  double time = 0.9;
  for (int step = 0; step < 50; ++step) {
    const double fallen = std::exp(-(k + 1.0) * time), c = 1.02 / (1.0 - 2.0 / 3.0 * fallen);
    const double b = -k * c * c / (4.0 * k + 2.0), decayed = (2.0 - c - b) * std::exp(-time);
    time += (decayed + b * fallen * fallen + c * fallen - 0.5) / (decayed + (k + 1.0) * c * fallen);
  }
  return time;
}
double rise_time(double q) { return std::log(1.5) / q; }

/// Largest relative error of the durations on a branch in k.
double error_of_durations(const Workspace& workspace, const std::string& name) {
  double worst = 0.0;
  for (const SolutionEntry& label : workspace.solutions(name)) {
    const double fall = fall_time(label.parameter(1)), rise = rise_time(label.parameter(2));
    worst = std::max(worst, std::abs(label.parameter(61) / fall - 1.0));
    worst = std::max(worst, std::abs(label.parameter(62) / rise - 1.0));
  }
  return worst;
}

const std::string branch = "run sharp -q -c start -d start ICP=[k] RL0=1 RL1=200 DS=2 DSMAX=20 NPR=5 NMX=40 ";

void start(const Workspace& workspace, const std::string& values = "PAR(k)=20") {
  workspace.write("sharp.tch", source);
  succeed(workspace, "simulate sharp -q --dat start " + values);
}

/// How many intervals the meshes of the segments have, from the internal values: after the kinds a mark, 8.
std::vector<int> own_intervals(const SolutionEntry& entry) {
  std::size_t at = 0;
  while (at < entry.internal.size() && entry.internal[at] != 8.0) at += 4;
  std::vector<int> counts;
  for (std::size_t k = at + 4; k < entry.internal.size(); ++k) {
    if (entry.internal[k] == 0.0 && (k == at + 4 || entry.internal[k - 1] == 1.0)) counts.push_back(-1);
    if (!counts.empty() && static_cast<std::size_t>(entry.internal[at + 2]) > k - at - 4) ++counts.back();
  }
  if (static_cast<double>(counts.size()) > (at < entry.internal.size() ? entry.internal[at + 1] : 0.0))
    counts.pop_back();  // zeros behind the last mesh
  return counts;
}

double difference(const SolutionEntry& a, const SolutionEntry& b) {
  REQUIRE(a.t.size() == b.t.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < a.t.size(); ++k)
    for (std::size_t i = 0; i < a.states[k].size(); ++i)
      largest = std::max(largest, std::abs(a.states[k][i] - b.states[k][i]));
  for (std::size_t k = 0; k < a.par.size(); ++k) largest = std::max(largest, std::abs(a.par[k] - b.par[k]));
  return largest;
}

/// The relative change of the states by Newton's first correction of a run's first point.
double first_change(const Workspace& workspace, const std::string& name) {
  std::istringstream text(workspace.read("d." + name));
  std::string line;
  while (std::getline(text, line) && line.find("STATE STEP") == std::string::npos) {
  }
  REQUIRE(std::getline(text, line));
  const std::vector<std::string> words = words_of(line);
  REQUIRE(words.size() == 7);
  return std::stod(words.back());
}

}  // namespace

TEST_CASE("with as many intervals, durations are more accurate on own meshes than on one in common") {
  const Workspace workspace;
  start(workspace, "PAR(k)=100");
  succeed(workspace, branch + "-o common NTST=12");
  succeed(workspace, branch + "-o own NTST=12 OWNMESH=1");
  const double in_common = error_of_durations(workspace, "common"), own = error_of_durations(workspace, "own");
  CAPTURE(in_common, own);
  CHECK(own > 1e-13);
  CHECK(own < in_common / 8.0);
  for (const SolutionEntry& label : workspace.solutions("own")) {
    const std::vector<int> counts = own_intervals(label);
    REQUIRE(counts.size() == 2);
    CHECK(counts[0] + counts[1] == 24);
    CHECK(counts[0] > 2 * counts[1]);
    CHECK(label.intervals >= counts[0]);
  }
  const Outcome checked = succeed(workspace, "verify own -p sharp");
  CHECK(checked.out.find("agree with forward integration") != std::string::npos);
}

TEST_CASE("restarts on own meshes are exact, from common ones and back too") {
  const Workspace workspace;
  start(workspace);
  succeed(workspace, branch + "-o own NTST=20 OWNMESH=1");
  succeed(workspace, branch + "-o common NTST=20");
  for (const SolutionEntry& stored : workspace.solutions("own")) {
    succeed(workspace, fmt::format("run sharp -q -c r.own -s own -o again NMX=1 IRS={}", stored.label));
    CHECK(first_change(workspace, "again") < 1e-12);
    const SolutionEntry again = workspace.solutions("again").front();
    CHECK(difference(stored, again) < 1e-12);  // all digits are written
    CHECK(again.internal == stored.internal);
  }
  for (const SolutionEntry& stored : workspace.solutions("common")) {
    succeed(workspace, fmt::format("run sharp -q -c r.common -s common -o again NMX=1 OWNMESH=1 IRS={}", stored.label));
    CHECK(first_change(workspace, "again") < 1e-9);  // ten decimals are written
    const SolutionEntry again = workspace.solutions("again").front();
    CHECK(difference(stored, again) < 2e-10);
    CHECK(own_intervals(again).empty());  // it is on one mesh yet
  }
  succeed(workspace, "run sharp -q -c r.common -s common -o on NMX=9 OWNMESH=1 IRS=2");
  CHECK(own_intervals(workspace.solutions("on").back()).size() == 2);
  succeed(workspace, "run sharp -q -c r.own -s own -o back OWNMESH=0 IRS=2 NMX=9");
  CHECK(error_of_durations(workspace, "back") < 1e-6);
  CHECK(workspace.solutions("back").back().intervals == 20);
  CHECK(own_intervals(workspace.solutions("back").back()).empty());
}

TEST_CASE("rotated and doubled, an orbit keeps its own meshes, and data made of it give each segment its own again") {
  const Workspace workspace;
  start(workspace);
  succeed(workspace, branch + "-o own NTST=20 OWNMESH=1");
  const std::vector<int> counts = own_intervals(workspace.solutions("own")[1]);
  REQUIRE(counts.size() == 2);
  succeed(workspace, "resegment -q q.own 2 --to rotate --by 1 -o turned -p sharp");
  succeed(workspace, "run sharp -q -c turned -s turned -o rotated NMX=1");
  CHECK(first_change(workspace, "rotated") < 1e-12);
  CHECK(own_intervals(workspace.solutions("rotated").front()) == std::vector<int>{counts[1], counts[0]});
  succeed(workspace, "resegment -q q.own 2 --to double -o twice -p sharp");
  succeed(workspace, "run sharp -q -c twice -s twice -o doubled NMX=1");
  CHECK(first_change(workspace, "doubled") < 1e-12);
  CHECK(own_intervals(workspace.solutions("doubled").front()) ==
        std::vector<int>{counts[0], counts[1], counts[0], counts[1]});
  succeed(workspace, "resegment -q q.own 2 --to rotate --by 1 --dat -o data -p sharp");
  succeed(workspace, "run sharp -q -c data -d data -o again NMX=1");
  const std::vector<int> again = own_intervals(workspace.solutions("again").front());
  REQUIRE(again.size() == 2);
  CHECK(again[1] > 2 * again[0]);
}

TEST_CASE("a segment that is a thousand times shorter than the other one") {
  const Workspace workspace;
  start(workspace, "PAR(k)=20 PAR(q)=1000");
  for (const std::string mesh : {"0", "1"}) {
    succeed(workspace, branch + "-o short NTST=40 OWNMESH=" + mesh);
    const auto labels = workspace.solutions("short");
    CHECK(labels.back().parameter(61) > 1000.0 * labels.back().parameter(62));
    CHECK(error_of_durations(workspace, "short") < 1e-7);
  }
}

TEST_CASE("meshes of segments that are damaged are refused, with the place") {
  const Workspace workspace;
  start(workspace);
  succeed(workspace, branch + "-o own NTST=8 OWNMESH=1 NMX=2");
  std::string text = workspace.read("q.own");
  const auto mark = text.rfind("8.0000000000000000E+000");
  REQUIRE(mark != std::string::npos);
  const auto segments = text.find("2.0000000000000000E+000", mark);
  REQUIRE(segments != std::string::npos);
  text[segments] = '3';
  workspace.write("q.damaged", text);
  const Outcome outcome = workspace.tchat("labels damaged");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("no meshes of the segments") != std::string::npos);
}

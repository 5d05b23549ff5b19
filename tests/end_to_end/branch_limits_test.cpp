// Labels have their evidence, and a branch ends where there are no orbits any more, or none that a mesh resolves.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool has_label(const std::vector<PointRow>& rows, int type) {
  for (const PointRow& row : rows)
    if (row.label != 0 && std::abs(row.type) == type) return true;
  return false;
}

/// Number of the first label of this type.
int with_type(const std::vector<PointSection>& sections, int type) {
  for (const PointRow& row : rows_of(sections))
    if (row.label != 0 && std::abs(row.type) == type) return row.label;
  return 0;
}

constexpr int fold = 5, branch_point = 6, torus = 8;

}  // namespace

TEST_CASE("a branch whose period passes infinity ends before it, with labels that are orbits") {
  const Workspace workspace;
  const Outcome outcome =
      workspace.run({"-c", "nonimpacting_alpha", "-d", "nonimpacting", "ICP=[omega,61]", "PAR(alpha)=0.5", "DS=-0.1",
                     "DSMAX=10", "RL0=-1", "RL1=4", "NMX=100", "GRSTOP=0", "-o", "slow"});
  INFO(outcome.text());
  CHECK(contains(outcome.out, "the period passes infinity"));
  CHECK_FALSE(contains(outcome.out, "homoclinic"));
  const std::vector<PointRow> rows = rows_of(workspace.points("slow"));
  CHECK_FALSE(has_label(rows, branch_point));
  CHECK_FALSE(has_label(rows, torus));
  // The forced oscillation has the period of its forcing. Newton's tolerance is 1e-10, the mesh's error 1e-9.
  for (const PointRow& row : rows) {
    const double omega = row.values.front(), period = row.values.back();
    INFO("omega = " << omega);
    CHECK(omega * period / (2.0 * std::numbers::pi) == Approx(1.0).epsilon(1e-8));
    CHECK(period > 0.0);
  }
}

TEST_CASE(
    "the tonic spikes of a neuron: a finer mesh where it is needed, and no fold where no mesh resolves the orbit") {
  const Workspace workspace;
  // E. M. Izhikevich, Simple model of spiking neurons, IEEE Trans. Neural Networks 14 (2003), 1569-1572.
  workspace.write("neuron.tch", R"(par I=30, a=0.02, b=0.2, c=-50, d=2
init v=-50, u=-5
v' = 0.04*v^2 + 5*v + 140 - u + I
u' = a*(b*v - u)
event spike = 30 - v
jump reset: v -> c, u -> u + d
after any: spike -> reset
)");
  REQUIRE(workspace.tchat("simulate neuron -q --dat start").status == 0);
  const Outcome outcome =
      workspace.tchat("run neuron -c start -d start -o tonic ICP=[I] RL0=-100 RL1=100 DS=-0.05 DSMAX=0.5 NMX=400");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "NTST = 100 from here on"));
  CHECK(contains(outcome.out, "stopped: NTST = 400 does not resolve"));
  const std::vector<PointRow> rows = rows_of(workspace.points("tonic"));
  CHECK_FALSE(has_label(rows, fold));
  CHECK(has_label(rows, 7));
  // The period doubling is confirmed by an independent integration. Later orbits follow a repelling part of
  // the slow manifold for so long that no integration over a whole period finds them.
  const Outcome verified = workspace.tchat("verify q.tonic PD1 -p neuron");
  INFO(verified.text());
  CHECK(verified.status == 0);
}

TEST_CASE("an integrator that hardly reaches its threshold has the period of the closed form, or no label") {
  const Workspace workspace;
  workspace.write("integrator.tch", R"(par a=2
init x=0
x' = a - x
event threshold = 1 - x
jump reset: x -> 0
after any: threshold -> reset
)");
  REQUIRE(workspace.tchat("simulate integrator -q --dat start").status == 0);
  const Outcome outcome =
      workspace.tchat("run integrator -c start -d start -o slow ICP=[a] RL0=0 RL1=3 DS=-0.05 DSMAX=0.5 NMX=100");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  for (const PointRow& row : rows_of(workspace.points("slow"))) {
    const double a = row.values.front(), period = row.values.back();
    if (row.label == 0) continue;
    INFO("a = " << a << ", period = " << period);
    CHECK(period < 37.0);
    // Files hold 11 digits of a, so that a - 1 is known to 1e-10; the mesh may leave the error that the run allows.
    const double low = std::max(a - 1e-10, 1.0 + 1e-16), high = a + 1e-10;
    CHECK(period >= std::log(high / (high - 1.0)) * (1.0 - 1e-2));
    CHECK(period <= std::log(low / (low - 1.0)) * (1.0 + 1e-2));
  }
}

TEST_CASE("a multiplier that crosses +1 while the parameter stands still is reported") {
  const Workspace workspace;
  // r' = 1e12 p + (r - 1)^2: a fold at p = 0, of a parameter that moves by 1e-12 while r moves by 1.
  workspace.write("still.tch", R"(par p=-1e-14
init r=0.9, t=0
r' = 1e12*p + (r - 1)^2
t' = 1
event turn = 1 - t
jump back: t -> 0
after any: turn -> back
)");
  REQUIRE(workspace.tchat("simulate still -q --dat start").status == 0);
  const Outcome outcome =
      workspace.tchat("run still -c start -d start -o still ICP=[p] RL0=-1 RL1=1 DS=0.01 DSMAX=0.1 NMX=12");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "the stability changes without a special point: one multiplier goes from"));
  CHECK(contains(outcome.out, "through +1"));
  CHECK(contains(workspace.read("d.still"), "the stability changes without a special point"));
}

TEST_CASE("BOUNDS ends a branch where a parameter, a duration or a monitor leaves its range") {
  const Workspace workspace;
  // The velocity of the impact is -MAX x2 of the forced motion's end: the monitor is a column of its own.
  const std::vector<std::string> words{"-c", "impacting", "-d", "impacting", "ICP=[alpha,velocity(1)]", "NMX=60"};
  const auto run = [&](const std::vector<std::string>& further) {
    std::vector<std::string> all = words;
    all.insert(all.end(), further.begin(), further.end());
    return workspace.run(all);
  };
  run({"-o", "free"});
  const std::vector<PointRow> free = rows_of(workspace.points("free"));
  const std::size_t column = workspace.points("free").front().column("velocity(1)");
  const double middle = 0.5 * (free.front().values[column] + free.back().values[column]);

  const Outcome beyond = run({fmt::format("BOUNDS={{velocity(1): [{}, 0]}}", middle), "-o", "beyond"});
  CHECK(contains(beyond.out, "velocity(1) left BOUNDS"));
  const std::vector<PointRow> rows = rows_of(workspace.points("beyond"));
  REQUIRE(rows.size() >= 2);
  CHECK(rows.back().values[column] < middle);
  CHECK(rows[rows.size() - 2].values[column] > middle);

  run({fmt::format("BOUNDS={{velocity(1): [{}, 0]}}", middle), "--clip", "-o", "clipped"});
  CHECK(rows_of(workspace.points("clipped")).back().values[column] == Approx(middle).epsilon(1e-8));
  CHECK(contains(workspace.read("r.clipped"), "BOUNDS = {velocity(1): ["));

  const auto refused = [&](const std::string& bounds, const std::vector<std::string>& parts) {
    std::vector<std::string> all{"run", "linosc", "-c", "impacting", "-d", "impacting", "-o", "none", bounds};
    const Outcome outcome = workspace.tchat(all);
    INFO(outcome.text());
    CHECK(outcome.status == 2);
    for (const std::string& part : parts) CHECK(contains(outcome.err, part));
    CHECK_FALSE(workspace.has("p.none"));
  };
  refused("BOUNDS={T1: [0, 0.1]}", {"outside of the bounds", "T1 is", "0 to 0.1"});
  refused("BOUNDS={T1: 3}", {"BOUNDS", "'T1'", "[0, 10]"});
  refused("BOUNDS={T1: [3, 2]}", {"BOUNDS", "'2'", "greater than 3"});
  refused("BOUNDS={nothing: [3, 4]}", {"BOUNDS", "nothing"});
  refused("BOUNDS={T9: [0, 1]}", {"BOUNDS", "(T9)"});
  refused("BOUNDS={1: [0, 9], alpha: [0, 9]}", {"BOUNDS", "twice"});
  refused("BOUNDS={77: [0, 9]}", {"BOUNDS", "'77'"});
}

TEST_CASE("the first label of each type is followed by a command that starts there") {
  const Workspace workspace(Workspace::Plugin::source);
  const auto follow = [&](const Outcome& outcome, const std::string& type, const std::string& made) {
    const std::size_t label = outcome.out.find("  " + type + " label ");
    REQUIRE(label != std::string::npos);
    const std::size_t next = outcome.out.find("next: ", label);
    REQUIRE(next != std::string::npos);
    const std::string command = outcome.out.substr(next + 6, outcome.out.find('\n', next) - next - 6);
    INFO(command);
    const Outcome done = workspace.shell(command + " NMX=3");
    INFO(done.text());
    CHECK(done.status == 0);
    CHECK(workspace.has("p." + made));
  };
  const Outcome back = workspace.run("-c impacting_20072 -d impacting IRS=0 DS=-0.02 -o back");
  follow(back, "PD", "back_PD" + std::to_string(with_type(workspace.points("back"), 7)));
  const Outcome smooth = workspace.run("-c nonimpacting_alpha -d nonimpacting IRS=0 DS=0.1 -o smooth RL1=4 UZR={}");
  follow(smooth, "GR", "smooth_GR" + std::to_string(with_type(workspace.points("smooth"), 4)) + "_branch");
}

TEST_CASE("constants name their problem: no command on the files of a run needs -p") {
  const Workspace workspace(Workspace::Plugin::source);
  REQUIRE(workspace.shell("mkdir out other && tchat simulate linosc -q 'PAR(alpha)=2' 'PAR(omega)=2.0072' --dat start")
              .status == 0);
  CHECK(contains(workspace.read("gc.start"), "PROBLEM = linosc "));
  const auto succeed = [&](const std::string& line) {
    const Outcome outcome = workspace.shell(line);
    INFO(line << '\n' << outcome.text());
    CHECK(outcome.status == 0);
    return outcome;
  };
  succeed("tchat run start -q DS=0.05 RL0=1 RL1=4 -o smooth");
  succeed("tchat resegment -q q.smooth GR1 --to impacting -o out/born NMX=40 RL1=3.2");
  CHECK(contains(workspace.read("out/gc.born"), "PROBLEM = \"../linosc\""));
  succeed("tchat run out/born -q -o out/impacting");
  CHECK(contains(workspace.read("out/r.impacting"), "PROBLEM = \"../linosc\""));
  succeed("tchat verify smooth");
  succeed("tchat grazing q.smooth GR1");
  succeed("cd out && tchat verify impacting");
  const Outcome elsewhere = succeed("cd other && tchat verify ../out/impacting");
  CHECK(contains(elsewhere.err, "plugin: ../linosc.cpp is compiled"));
  // What a user names comes first, then a plugin with the run's own name.
  workspace.write("none.tch", "par a=1\nx' = a\n");
  CHECK(workspace.shell("tchat verify smooth -p none").status == 2);
  workspace.write("smooth.tch", "par a=1\nx' = a\n");
  CHECK(workspace.shell("tchat verify smooth").status == 2);
}

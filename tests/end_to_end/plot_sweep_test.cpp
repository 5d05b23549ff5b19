// tchat plot of sweeps through the binary: dots beneath branches, maps, exponents, panels side by side; refusals.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

constexpr const char* dots =
    "# tchat sweep of linosc\n# over alpha from 2.9 to 3.3, 3 values\n# PAR omega = 2.0072\n# start 1: x = (0,0,0,1)\n"
    "index alpha start attractor kind period time impacts lambda1 error1 x1 x2\n"
    "0 2.9 1 1 periodic 1 3.13 1 -0.25 0.01 1 -0.5\n1 3.1 1 1 periodic 1 3.13 1 -0.125 0.02 1 -0.75\n"
    "2 3.3 1 0 none nan nan -1 0.5 0.04 1 -0.25\n2 3.3 1 0 none nan nan -1 0.5 0.04 1 -0.875\n";

constexpr const char* map =
    "# tchat sweep of linosc\n# over alpha from 2 to 3, 2 values\n# over x1 from -1 to 1, 3 values, initial state\n"
    "# start 1: x = (0,0,0,1)\n"
    "# attractor 1: periodic, signature {(1,1,1)}, impacts 1, period 3.125, index 0, mode 1,1,1, state 0,0,0,1\n"
    "index alpha x1(0) start attractor kind penetration\n0 2 -1 1 1 periodic 0.25\n1 3 -1 1 0 escape nan\n"
    "2 2 0 1 1 periodic 0.5\n3 3 0 1 1 periodic 0.75\n4 2 1 1 1 periodic 0\n5 3 1 1 0 escape nan\n";

/// A branch and two sweeps.
const Workspace& prepared() {
  static const Workspace workspace;
  static const bool made = [] {
    workspace.run("-c impacting -d impacting -o branch NMX=8 NTST=20 DS=-0.02 NPR=1 -q");
    workspace.write("brute.sweep", dots);
    workspace.write("basin.sweep", map);
    return true;
  }();
  static_cast<void>(made);
  return workspace;
}

std::string script_of(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("plot " + arguments + " -o picture.svg --script picture.gp");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(outcome.err.empty());
  CHECK(contains(workspace.read("picture.svg"), "<svg"));
  return workspace.read("picture.gp");
}

}  // namespace

TEST_CASE("dots of a sweep over its parameter, by the name of the run or of the file") {
  const Workspace& workspace = prepared();
  for (const std::string name : {"brute.sweep", "brute"}) {
    const std::string script = script_of(workspace, name);
    CHECK(contains(script, "$cloud1_1 << END\n2.9 1 0\n3.1 1 0\n3.3 1 0\nEND\n"));
    CHECK(contains(script, "set xlabel 'α'"));
    CHECK(contains(script, "set ylabel 'x_{1}'"));
  }
  CHECK(contains(script_of(workspace, "brute -y x2"),
                 "$cloud1_1 << END\n2.9 -0.5 0\n3.1 -0.75 0\n3.3 -0.25 0\n3.3 -0.875 0\nEND\n"));
  CHECK(contains(script_of(workspace, "brute -x alpha/omega -y 2*x2"), fmt::format("{:.10g} -1 0\n", 2.9 / 2.0072)));
}

TEST_CASE("a sweep lies beneath the branches of a run") {
  const Workspace& workspace = prepared();
  const std::string script =
      script_of(workspace, "p.branch brute -y x2@wall --dots x2 --legend branch --legend simulation");
  CHECK(contains(script, "3.3 -0.875 0\n"));
  CHECK(script.find("plot $cloud1_1 with points") < script.find("$curve1_1 with lines"));
  CHECK(contains(script, "set label 'branch'"));
  CHECK(contains(script, "set label 'simulation'"));
  CHECK(contains(script, "#a8a8a8"));  // pale
}

TEST_CASE("branches that show another quantity than the dots of a sweep are told, with what shows the same") {
  const Workspace& workspace = prepared();
  const std::string sentence = "which is something else";
  for (const auto& [arguments, shown] : {std::pair{"", "the L2 norm"}, {" -y x2", "the largest value of a state"}}) {
    const Outcome different = workspace.tchat(fmt::format("plot p.branch brute{} -o different.svg", arguments));
    INFO(different.text());
    CHECK(different.status == 0);
    CHECK(contains(different.err, fmt::format("branches show {}, the dots", shown)));
    CHECK(contains(different.err, sentence));
    CHECK(contains(different.err, "-y STATE@EVENT --dots STATE"));
    CHECK(workspace.has("different.svg"));
  }
  for (const std::string arguments : {"p.branch", "brute", "p.branch brute -y x2@wall --dots x2"})
    CHECK_FALSE(contains(workspace.tchat("plot " + arguments + " -o same.svg").text(), sentence));
}

TEST_CASE("exponents have bars of their errors") {
  const std::string script = script_of(prepared(), "brute -y lambda1");
  CHECK(contains(script, "$cloud1_1 << END\n2.9 -0.25 0\n3.1 -0.125 0\n3.3 0.5 0\nEND\n"));
  CHECK(contains(script, "2.9 -0.26\n2.9 -0.24\n\n3.1 -0.145\n3.1 -0.105\n"));
  CHECK(contains(script, "set ylabel 'λ_{1}'"));
}

TEST_CASE("a basin in the colours of its attractors, and in a scale of a number") {
  const std::string basin = script_of(prepared(), "basin");
  CHECK(contains(basin, "$field1 << END\n0 1\n0 0\n0 1\nEND\n"));
  CHECK(contains(basin, "with image"));
  CHECK(contains(basin, "set label '1: 1 impact, period 3.125'"));
  CHECK(contains(basin, "set label 'no attractor'"));
  CHECK(contains(script_of(prepared(), "basin --legend trapped --legend gone"), "set label 'gone'"));
  const std::string depth = script_of(prepared(), "basin -z penetration --zlabel depth");
  CHECK(contains(depth, "$field1 << END\n0.25 nan\n0.5 0.75\n0 nan\nEND\n"));  // nan: the paper shows
  CHECK(contains(depth, "set label 'depth'"));
  CHECK(contains(script_of(prepared(), "basin --at alpha=2 -y penetration"),
                 "$cloud1_1 << END\n-1 0.25 0\n0 0.5 0\n1 0 0\nEND\n"));
}

TEST_CASE("panels side by side: each with its files, quantities, texts and title") {
  const Workspace& workspace = prepared();
  const std::string script =
      script_of(workspace, "brute -y x2 -y lambda1 --title left --title right --legend a --legend b --panel brute");
  CHECK(contains(script, "size 1600,650"));
  CHECK(contains(script, "$cloud1_1 << END\n2.9 -0.5 0\n"));
  CHECK(contains(script, "$cloud2_1 << END\n2.9 -0.25 0\n"));
  CHECK(script.find("set label 'left'") < script.find("set label 'right'"));
  CHECK(contains(script, "set ylabel 'x_{2}'"));
  CHECK(contains(script, "set ylabel 'λ_{1}'"));
  const std::string mixed =
      script_of(workspace, "basin --panel p.branch --panel q.branch EP1 --size 2100x600 --title together");
  CHECK(contains(mixed, "size 2100,600"));
  CHECK(contains(mixed, "$field1"));
  CHECK(contains(mixed, "$curve2_1"));
  CHECK(contains(mixed, "$curve3_1"));
  CHECK(contains(mixed, "set label 'together'"));
  const std::string same = script_of(workspace, "brute -y x1 -y x2 --same-ranges --panel brute");
  const std::size_t first = same.find("set yrange"), second = same.find("set yrange", first + 1);
  CHECK(same.substr(first, 30) == same.substr(second, 30));
}

TEST_CASE("a large sweep and a large map are drawn, to small files") {
  const Workspace& workspace = prepared();
  std::string rows =
      "# tchat sweep of linosc\n# over alpha from 0 to 1, 1000 values\n# start 1: x = (0)\nindex alpha start kind x1\n";
  for (int k = 0; k < 160000; ++k)
    rows += fmt::format("{} {:.6f} 1 chaotic {:.6f}\n", k / 160, (k / 160) / 999.0, std::sin(k * 1.7 * k));
  workspace.write("large.sweep", rows);
  std::string cells =
      "# tchat sweep of linosc\n# over x1 from 0 to 1, 400 values, initial state\n# over x2 from 0 to 1, 400 values, "
      "initial state\n"
      "# start 1: x = (0)\nindex x1(0) x2(0) start kind penetration\n";
  for (int k = 0; k < 160000; ++k)
    cells += fmt::format("{} {:.6f} {:.6f} 1 {} {:.5f}\n", k, (k % 400) / 399.0, (k / 400) / 399.0,
                         k % 7 == 0 ? "chaotic" : "periodic", std::sin(0.001 * k));
  workspace.write("wide.sweep", cells);
  for (const std::string arguments : {"large.sweep", "wide.sweep", "wide.sweep -z penetration"})
    for (const std::string form : {"png", "svg", "pdf"}) {
      INFO(arguments << ' ' << form);
      const Outcome outcome = workspace.tchat("plot " + arguments + " -o large." + form);
      INFO(outcome.text());
      CHECK(outcome.status == 0);
      CHECK(std::filesystem::file_size(workspace.file("large." + form)) < 12'000'000);
    }
}

TEST_CASE("bad usage of plot with sweeps is refused with what there is") {
  const Workspace& workspace = prepared();
  workspace.write("headless.sweep", "# tchat sweep of linosc\n# over alpha from 2.9 to 3.3, 3 values\n");
  workspace.write("cut.sweep", std::string(dots).substr(0, std::string(dots).size() - 5));
  struct Bad {
    std::string arguments;
    std::vector<std::string> expected;
  };
  for (const Bad& bad : {Bad{"brute -y nosuch", {"brute.sweep: -y 'nosuch'", "x1, x2, kind, omega"}},
                         Bad{"brute -x 1/nosuch", {"'nosuch'", "-x"}},
                         Bad{"brute -z nosuch", {"-z 'nosuch'"}},
                         Bad{"brute -y x1@+9", {"nowhere a number"}},
                         Bad{"brute PD1", {"brute.sweep is a sweep", "PD1"}},
                         Bad{"brute --at alpha", {"--at 'alpha'", "--at mu=-0.8"}},
                         Bad{"brute --at alpha=9", {"from 2.9 to 3.3"}},
                         Bad{"brute --at beta=9", {"no column"}},
                         Bad{"p.branch --at alpha=3", {"--at is for sweeps"}},
                         Bad{"p.branch --dots x1", {"--dots is for sweeps"}},
                         Bad{"basin basin", {"one map", "--panel"}},
                         Bad{"basin --logx", {"linear axes"}},
                         Bad{"basin brute --legend a --legend b --legend c --legend d", {"4 times"}},
                         Bad{"brute -y x1 -y x2", {"-y is given 2 times for 1 panel"}},
                         Bad{"brute -y x1 -y x2 -y x1 --panel brute", {"3 times for 2 panels"}},
                         Bad{"q.branch EP1 -x x1 -y x2 -z y1 --panel q.branch EP1", {"in space"}},
                         Bad{"brute --panel nosuch", {"'nosuch'"}},
                         Bad{"brute q.branch EP1", {"brute.sweep is no q-file"}},
                         Bad{"headless.sweep", {"headless.sweep:2", "column names"}},
                         Bad{"cut.sweep", {"cut.sweep:9"}}}) {
    INFO("tchat plot " << bad.arguments);
    check_refused(workspace.tchat("plot " + bad.arguments + " -o bad.png"), bad.expected);
    CHECK_FALSE(workspace.has("bad.png"));
  }
}

// tchat explore: diagrams whose special points are known in closed form, the same whatever is done at a time or
// interrupted, and by make alone.
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <regex>
#include <thread>

#include "end_to_end/bouncing_ball.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// The parameter of the first line of the tree that has `text`.
double value_of(const std::string& tree, const std::string& text) {
  const std::size_t at = tree.find(text);
  INFO(text << " in\n" << tree);
  REQUIRE(at != std::string::npos);
  return std::stod(tree.substr(at + text.size()));
}

/// The names of p- and q-files of the tree's branches in a folder.
std::vector<std::string> branch_files(const Workspace& workspace, const std::string& folder) {
  const std::string makefile = workspace.read("Makefile." + folder);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(workspace.file(folder))) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("p.") && !name.starts_with("q.")) continue;
    if (makefile.find(folder + "/" + name + " ") != std::string::npos) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// An orbit by its states where segments begin.
struct FoundOrbit {
  std::string branch;
  double parameter = 0.0;
  std::vector<std::vector<double>> states;
};

/// At user values, on all branches of the tree.
std::vector<FoundOrbit> orbits_at_user_values(const Workspace& workspace, const std::string& folder) {
  std::vector<FoundOrbit> orbits;
  for (const std::string& name : branch_files(workspace, folder)) {
    if (!name.starts_with("q.")) continue;
    for (const SolutionEntry& entry : read_solutions(workspace.read(folder + "/" + name))) {
      if (entry.internal.empty() || entry.internal.front() != 1.0) continue;
      FoundOrbit orbit{name, std::round(entry.parameter(1) * 1e8) * 1e-8, {}};
      const std::vector<double>& first = entry.states.front();
      const auto n = static_cast<std::size_t>(entry.dimension);
      for (std::size_t at = 0; at + n <= first.size(); at += n)
        orbit.states.emplace_back(first.begin() + static_cast<std::ptrdiff_t>(at),
                                  first.begin() + static_cast<std::ptrdiff_t>(at + n));
      orbits.push_back(orbit);
    }
  }
  return orbits;
}

/// The largest difference of states, whichever segment of `b` is the first, and however often the orbits are run.
double distance(const FoundOrbit& a, const FoundOrbit& b) {
  const std::size_t count = std::lcm(a.states.size(), b.states.size());
  double least = INFINITY;
  for (std::size_t shift = 0; shift < b.states.size(); ++shift) {
    double largest = 0.0;
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t i = 0; i < a.states.front().size(); ++i)
        largest =
            std::max(largest, std::abs(a.states[k % a.states.size()][i] - b.states[(k + shift) % b.states.size()][i]));
    least = std::min(least, largest);
  }
  return least;
}

/// The q-files of the runs along `known` that correct orbits to compare with those of `branch`; "": of any.
std::vector<std::string> corrections_of(const Workspace& workspace, const std::string& branch, const std::string& known,
                                        const std::string& folder = "one") {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(workspace.file(folder))) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("q." + branch) && name.find("_like_" + known) != std::string::npos && name.back() != '~')
      names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Kills `command` at random times in folder `killed`, and then lets it end: the same tree and files as in `one`.
void check_resumed(const Workspace& workspace, const std::string& command, int kills) {
  const std::string tree = workspace.read("one.txt");
  std::mt19937 random(20);
  std::uniform_int_distribution<int> milliseconds(20, 900);
  while (kills > 0) {
    const std::unique_ptr<Process> process = workspace.start_tchat(command + " -o killed -q");
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds(random)));
    if (!process->ended()) {
      --kills;  // with `process`
      continue;
    }
    CHECK(workspace.read("killed.txt") == tree);
    std::filesystem::remove_all(workspace.file("killed"));
  }
  REQUIRE(workspace.tchat(command + " -o killed").status == 0);
  CHECK(workspace.read("killed.txt") == tree);
  for (const std::string& name : branch_files(workspace, "one"))
    CHECK(workspace.read("killed/" + name) == workspace.read("one/" + name));
}

/// The tree of an exploration in the folder `one`.
std::string explored(const Workspace& workspace, const std::string& arguments) {
  const Outcome outcome = workspace.tchat("explore " + arguments + " -o one -j 2 -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return workspace.read("one.txt");
}

/// No orbit at a user value lies on two branches in the folder `one`. Returns how many there are.
std::size_t count_different_orbits(const Workspace& workspace) {
  const std::vector<FoundOrbit> orbits = orbits_at_user_values(workspace, "one");
  for (const FoundOrbit& a : orbits)
    for (const FoundOrbit& b : orbits) {
      if (a.branch >= b.branch || a.parameter != b.parameter) continue;
      INFO(a.branch << " and " << b.branch << " at " << a.parameter);
      CHECK(distance(a, b) > 1e-5);
    }
  return orbits.size();
}

const std::string exploration = "explore ball --over Gamma=1:1.7:71 --doublings 2";

}  // namespace

TEST_CASE("explore: the diagram's folder does not hide the problem") {
  const Workspace workspace;
  const Outcome refused = workspace.tchat("explore linosc --over alpha=1.5:4:11 -o linosc");
  CHECK(refused.status == 2);
  CHECK(refused.err.find("-o linosc.diagram") != std::string::npos);
  CHECK_FALSE(workspace.has("linosc.txt"));
}

TEST_CASE("the bouncing ball: all period doublings from one command, every periodic attractor on a branch") {
  // With g = 1 and one bounce a period: pi (1 - r) / (1 + r) = Gamma cos(phase) at its birth and, for r = 1/2, its
  // doubling at Gamma^2 = (pi/3)^2 + (10/9)^2.
  const Workspace workspace;
  workspace.write("ball.tch", bouncing_ball);
  const Outcome outcome = workspace.tchat(exploration + " -o one -j 2");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("one.txt");
  CHECK(value_of(tree, "LP 4 at ") == Approx(M_PI / 3.0).epsilon(1e-8));
  CHECK(value_of(tree, "PD 2 at ") == Approx(std::hypot(M_PI / 3.0, 10.0 / 9.0)).epsilon(1e-8));
  CHECK(tree.find("(100 %)") != std::string::npos);

  {
    INFO("one command at a time gives the same");
    REQUIRE(workspace.tchat(exploration + " -o two").status == 0);
    std::string other = workspace.read("two.json");
    for (std::size_t at = other.find("two/"); at != std::string::npos; at = other.find("two/"))
      other.replace(at, 3, "one");
    CHECK(other == workspace.read("one.json"));
  }
  {
    INFO("killed at random times, it goes on to the same tree");
    check_resumed(workspace, exploration, all_tests() ? 20 : 6);
  }
  {
    INFO("make alone makes the same files");
    REQUIRE(workspace.shell("mkdir made && cp ball.tch Makefile.one made").status == 0);
    const Outcome made = workspace.make("made", "-s -j2 -f Makefile.one");
    INFO(made.text());
    REQUIRE(made.status == 0);
    for (const std::string& name : branch_files(workspace, "one")) {
      INFO(name);
      CHECK(workspace.read("made/one/" + name) == workspace.read("one/" + name));
    }
  }
  {
    INFO("parts that are made one by one are the whole");
    REQUIRE(workspace.shell("mkdir parts && cp ball.tch Makefile.one parts").status == 0);
    for (const char* const part : {"1", "2", "3"})
      REQUIRE(workspace.make("parts", std::string("-s -f Makefile.one part PARTS=3 PART=") + part).status == 0);
    CHECK(workspace.make("parts", "-q -f Makefile.one branches").status == 0);
    for (const std::string& name : branch_files(workspace, "one"))
      CHECK(workspace.read("parts/one/" + name) == workspace.read("one/" + name));
  }
}

TEST_CASE("no orbit lies on two branches of an exploration") {
  const Workspace workspace;
  workspace.write("ball.tch", bouncing_ball);
  // Values that are far from bifurcations.
  const Outcome outcome = workspace.tchat({"explore", "ball", "--over", "Gamma=1:1.71:72", "-o", "one", "-j", "2", "-q",
                                           "UZR={Gamma:[1.2,1.4,1.6,1.68,1.7,1.7035,1.7095]}"});
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  CHECK(count_different_orbits(workspace) > 20);
}

TEST_CASE("a branch that ends where an impact has velocity zero is known on another way to it") {
  // The branch of one maximum a period, which two others reach where they graze, turns where its maximum vanishes.
  const Workspace workspace;
  std::filesystem::copy(MEMS_SOURCE, workspace.file("mems.cpp"));
  const std::string tree = explored(
      workspace, "mems --over V=0.355:0.445:19 --segments 7 --starts 0 DS=0.004 DSMAX=0.04 UZR={V:[0.38,0.4]}");
  INFO(tree);
  CHECK(count_different_orbits(workspace) > 8);
  for (const auto& entry : std::filesystem::directory_iterator(workspace.file("one"))) {
    INFO(entry.path());
    CHECK(entry.path().string().back() != '~');  // no run has written over the files of another
  }
}

TEST_CASE("where one direction from a branch point is known, the other one alone is a branch") {
  // Close to a contact the switch at the branch point leads back to the branch that it leaves. Two contacts come at the
  // branch point itself, by symmetry, which then is found from some starts and not from others.
  const Workspace workspace;
  std::filesystem::copy(RELAY_SOURCE, workspace.file("relay.cpp"));
  const std::string tree = explored(workspace,
                                    "relay --over omega=7.15:7.5:15 PAR(zeta)=0.05 --starts 0 --branches 3 "
                                    "UZR={omega:[7.18,7.25,7.29,7.35,7.45]}");
  INFO(tree);
  CHECK(std::regex_search(tree, std::regex("BP [0-9]+ of b2 at .*, the other direction is b[0-9]+\n")));
  CHECK(count_different_orbits(workspace) > 12);
}

TEST_CASE("a branch that is met where it has no label is known by an orbit that a further run corrects") {
  const Workspace workspace;
  workspace.write("ball.tch", bouncing_ball);
  const std::string command = "explore ball --over Gamma=1:1.7:71 --doublings 1 NMX=30 -q";  // runs end anywhere
  REQUIRE(workspace.tchat(command + " -o one -j 1").status == 0);
  REQUIRE(workspace.tchat(command + " -o two -j 2").status == 0);
  const std::string tree = workspace.read("one.txt");
  INFO(tree);
  CHECK(corrections_of(workspace, "", "b3").size() == 1);
  CHECK(tree.find("BP 2 at 1.696780746 -> b3") != std::string::npos);
  CHECK(tree.find("7 branches.") != std::string::npos);
  CHECK(workspace.read("two.txt") == tree);
  check_resumed(workspace, command, 10);
  // Each is there once more.
  CHECK(corrections_of(workspace, "", "", "killed") == corrections_of(workspace, "", ""));
  for (const std::string& name : corrections_of(workspace, "", ""))
    CHECK(workspace.read("killed/" + name) == workspace.read("one/" + name));
}

TEST_CASE("the impact oscillator: resegmentation at grazing joins the branches of two attractors") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat("explore linosc --over alpha=2.5:3.5:51 PAR(omega)=2.0072 -o osc -q");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("osc.txt");
  // The amplitude reaches the wall at |1 - omega^2 + 2 i zeta omega|.
  const double omega = 2.0072;
  CHECK(value_of(tree, "GR 2 at ") == Approx(std::hypot(1.0 - omega * omega, 0.1 * omega)).epsilon(1e-8));
  CHECK(tree.find("GR 2 at 3.035495345 -> b2") != std::string::npos);
  CHECK(value_of(tree, "PD 3 at ") == Approx(3.036193566).epsilon(1e-9));
}

TEST_CASE("ranges that are none are refused with the form") {
  const Workspace workspace;
  for (const char* const words : {"alpha", "alpha=3", "alpha=3:2", "alpha=1:2:1", "=1:2", "alpha=1:x"}) {
    const Outcome outcome = workspace.tchat(std::string("explore linosc --over ") + words);
    CHECK(outcome.status == 2);
    CHECK(outcome.text().find("as alpha=2.9:3.3") != std::string::npos);
  }
  CHECK(workspace.tchat("explore linosc --over beta=1:2").text().find("is no parameter of problem") !=
        std::string::npos);
}

namespace {

/// An oscillator against a wall; without impacts its amplitude is alpha / |1 - omega^2 + 2 i zeta omega|.
std::string oscillator(double zeta) {
  return fmt::format(
      "par alpha=2.5, omega=2.0072, zeta={}, r=0.8\ninit y2=1\ngrowth = 1 - y1^2 - y2^2\nx' = v\n"
      "v' = alpha*y2 - 2*zeta*v - x\ny1' = growth*y1 + omega*y2\ny2' = growth*y2 - omega*y1\n"
      "event wall = 1 - x\nevent maximum = v\njump impact: v -> -r*v\nafter any: wall -> impact, maximum -> identity\n",
      zeta);
}

double grazing(double zeta) {
  constexpr double omega = 2.0072;
  return std::hypot(1.0 - omega * omega, 2.0 * zeta * omega);
}

const std::string short_exploration = "explore osc --over alpha=2.5:3.5:6 --starts 0 --branches 1 -q";

}  // namespace

TEST_CASE("after the model or the constants are edited, the same command computes the diagram of what is there") {
  const Workspace workspace;
  const auto found = [&](const std::string& more) {
    const Outcome outcome = workspace.tchat(short_exploration + " -o d" + more);
    INFO(outcome.text());
    REQUIRE(outcome.status == 0);
    return value_of(workspace.read("d.txt"), "GR 2 at ");
  };
  workspace.write("osc.tch", oscillator(0.05));
  CHECK(found("") == Approx(grazing(0.05)).epsilon(1e-8));
  REQUIRE(workspace.make(".", "-q -f Makefile.d").status == 0);
  const std::string points = workspace.read("d/p.b1");
  workspace.write("osc.tch", oscillator(0.3));
  CHECK(workspace.make(".", "-q -f Makefile.d").status == 1);  // the model is a prerequisite
  CHECK(found("") == Approx(grazing(0.3)).epsilon(1e-8));
  workspace.write("osc.tch", oscillator(0.05));
  CHECK(found("") == Approx(grazing(0.05)).epsilon(1e-8));
  CHECK(workspace.read("d/p.b1") == points);

  workspace.write("d/p.b1", "");  // and so are files that something else has written over
  CHECK(found("") == Approx(grazing(0.05)).epsilon(1e-8));
  CHECK(workspace.read("d/p.b1") == points);

  for (const char* const degree : {"NCOL = 5", "NCOL = 3"}) {
    REQUIRE(workspace.shell(fmt::format("sed 's/^NCOL = .*/{}/' d/gc.b1 > gc.mine", degree)).status == 0);
    found(" -c mine");
    CHECK(workspace.read("d/gc.b1").find(degree) != std::string::npos);
  }
}

TEST_CASE("one exploration at a time writes in a folder, and the other one says so") {
  const Workspace workspace;
  workspace.write("osc.tch", oscillator(0.05));
  REQUIRE(workspace.tchat("check osc").status == 0);  // compiled
  const std::unique_ptr<Process> first = workspace.start_tchat("explore osc --over alpha=2.5:3.5:201 -o d -q");
  while (!workspace.has("d/.sweep.log") && !first->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const Outcome second = workspace.tchat("explore osc --over alpha=2.5:3.5:201 -o d -q");
  CHECK(second.status == 2);
  CHECK(second.err.find("d: another tchat (process ") != std::string::npos);
}

TEST_CASE("folders that a Makefile cannot name, or that cannot be written, are refused before any work") {
  const Workspace workspace;
  workspace.write("osc.tch", oscillator(0.05));
  const auto refusal = [&](const std::string& folder) {
    const Outcome outcome = workspace.tchat({"explore", "osc", "--over", "alpha=2.5:3.5:6", "-o", folder});
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("internal") == std::string::npos);
    return outcome.err;
  };
  for (const char* const folder : {"a b", "a:b", "a=b", "a;b", "a'b", "a\"b", "a$b", "a#b", "a%b", "a*b"}) {
    INFO(folder);
    CHECK(refusal(folder).find("a Makefile cannot name files in a folder with") != std::string::npos);
  }
  CHECK(refusal("").find("a folder with a name of its own") != std::string::npos);
  CHECK(refusal("osc.tch").find("this is a file") != std::string::npos);
  CHECK(refusal("osc.tch/d").find("the folder cannot be made") != std::string::npos);
  workspace.write("d.png", "of the user");
  REQUIRE(workspace.tchat(short_exploration + " -o ./d/").status == 0);
  CHECK(workspace.read("d.png~") == "of the user");
  CHECK(workspace.read("d.png") != "of the user");
}

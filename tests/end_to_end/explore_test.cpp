// tchat explore: diagrams whose special points are known in closed form, the same whatever is done at a time or
// interrupted, and by make alone.
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <thread>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* ball = R"(par Gamma=1.3, r=0.5
init velocity=3, w=1.3
growth = 1 - (table^2 + w^2)/Gamma^2
height'   = velocity
velocity' = -1
table'    = growth*table + w
w'        = growth*w - table
event contact = height - table
jump impact: velocity -> -r*velocity + (1 + r)*w
after any: contact -> impact
)";

/// The parameter of the first line of the tree that has `text`.
double value_of(const std::string& tree, const std::string& text) {
  const std::size_t at = tree.find(text);
  INFO(text << " in\n" << tree);
  REQUIRE(at != std::string::npos);
  return std::stod(tree.substr(at + text.size()));
}

const std::string exploration = "explore ball --over Gamma=1:1.7:71 --doublings 2";

}  // namespace

TEST_CASE("the bouncing ball: all period doublings from one command, every periodic attractor on a branch") {
  // With g = 1 and one bounce a period: pi (1 - r) / (1 + r) = Gamma cos(phase) at its birth and, for r = 1/2, its
  // doubling at Gamma^2 = (pi/3)^2 + (10/9)^2.
  const Workspace workspace;
  workspace.write("ball.tch", ball);
  const Outcome outcome = workspace.tchat(exploration + " -o one -j 2");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  const std::string tree = workspace.read("one.txt");
  CHECK(value_of(tree, "LP 4 at ") == Approx(M_PI / 3.0).epsilon(1e-8));
  CHECK(value_of(tree, "PD 2 at ") == Approx(std::hypot(M_PI / 3.0, 10.0 / 9.0)).epsilon(1e-8));
  CHECK(tree.find("(100 %)") != std::string::npos);

  SECTION("one command at a time gives the same") {
    REQUIRE(workspace.tchat(exploration + " -o two").status == 0);
    std::string other = workspace.read("two.json");
    for (std::size_t at = other.find("two/"); at != std::string::npos; at = other.find("two/"))
      other.replace(at, 3, "one");
    CHECK(other == workspace.read("one.json"));
  }
  SECTION("a killed exploration goes on, and nothing is done again") {
    for (int k = 0; k < 4; ++k) {
      const std::unique_ptr<Process> process = workspace.start_tchat(exploration + " -o killed -q");
      std::this_thread::sleep_for(std::chrono::milliseconds(150 + 170 * k));  // and is killed with `process`
    }
    REQUIRE(workspace.tchat(exploration + " -o killed").status == 0);
    CHECK(workspace.read("killed.txt") == tree);
  }
  SECTION("make alone makes the same files") {
    REQUIRE(workspace.shell("mkdir made && cp ball.tch Makefile.one made").status == 0);
    const Outcome made = workspace.make("made", "-s -j2 -f Makefile.one");
    INFO(made.text());
    REQUIRE(made.status == 0);
    for (const char* const name : {"p.a1", "q.a1", "p.a2"}) {
      INFO(name);
      CHECK(workspace.read(std::string("made/one/") + name) == workspace.read(std::string("one/") + name));
    }
  }
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
  CHECK(tree.find("GR 2 at 3.035495345 -> a2") != std::string::npos);
  CHECK(value_of(tree, "PD 3 at ") == Approx(3.036193566).epsilon(1e-9));
}

TEST_CASE("ranges that are none are refused with the form") {
  const Workspace workspace;
  for (const char* const words : {"alpha", "alpha=3", "alpha=3:2", "alpha=1:2:1", "=1:2", "alpha=1:x"}) {
    const Outcome outcome = workspace.tchat(std::string("explore linosc --over ") + words);
    CHECK(outcome.status == 2);
    CHECK(outcome.text().find("as alpha=2.9:3.3") != std::string::npos);
  }
  CHECK(workspace.tchat("explore linosc --over beta=1:2").text().find("no parameter of this name") !=
        std::string::npos);
}

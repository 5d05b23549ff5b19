// Problems written as formulas, run by the program: the numbers of the same problems in C++, and what is said of
// mistakes.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

constexpr const char* oscillator = R"(# The linear impact oscillator of problems/linosc
par alpha=3, omega=2, zeta=0.05, r=0.8
init x1=0, x2=0, y1=0, y2=1
radius2 = y1^2 + y2^2
x1' = x2
x2' = alpha*y2 - 2*zeta*x2 - x1
y1' = y1 + omega*y2 - y1*radius2
y2' = y2 - omega*y1 - y2*radius2
event wall = 1 - x1
event maximum = x2
event minimum = -x2
jump impact: x2 -> -r*x2
jump identity
after any: wall -> impact, maximum -> identity
)";

std::string contents_of(const std::string& path) {
  std::ifstream in(path);
  REQUIRE(in);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The same rows, every number to 1e-12 of its column's size.
void check_same_points(const Workspace& workspace, const std::string& a, const std::string& b) {
  const auto rows = rows_of(workspace.points(a)), others = rows_of(workspace.points(b));
  REQUIRE(rows.size() == others.size());
  CHECK(rows.size() > 5);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    INFO("row " << k);
    CHECK(rows[k].point == others[k].point);
    CHECK(rows[k].type == others[k].type);
    REQUIRE(rows[k].values.size() == others[k].values.size());
    for (std::size_t c = 0; c < rows[k].values.size(); ++c)
      CHECK(rows[k].values[c] == Approx(others[k].values[c]).epsilon(1e-12).margin(1e-12));
  }
}

}  // namespace

TEST_CASE("the linear impact oscillator as formulas gives the numbers of its C++") {
  const Workspace workspace;
  workspace.write("written.tch", oscillator);
  for (const char* name : {"impacting", "nonimpacting_alpha"}) {
    const std::string data = std::string(name) == "impacting" ? "impacting" : "nonimpacting";
    const std::string files = " -c " + std::string(name) + " -d " + data;
    REQUIRE(workspace.tchat("run linosc" + files + " -o cpp").status == 0);
    const Outcome run = workspace.tchat("run written.tch" + files + " -o formulas");
    INFO(run.text());
    REQUIRE(run.status == 0);
    check_same_points(workspace, "formulas", "cpp");
  }
  CHECK(workspace.has("written.tch.so"));
  CHECK(workspace.tchat("verify q.formulas -p written").status == 0);
}

TEST_CASE("the bouncing ball as formulas gives the numbers of its C++, and those of its closed form") {
  const Workspace workspace;
  const std::string source = BALL_SOURCE;  // ball.cpp and ball.tch beside each other, as the user has them
  for (const char* kind : {".cpp", ".tch"}) workspace.write("ball" + std::string(kind), contents_of(source + kind));
  workspace.write("gc.ball", contents_of(BALL_CONSTANTS));
  REQUIRE(workspace.tchat("simulate ball.tch --dat bounce -o bounce").status == 0);
  REQUIRE(workspace.tchat("run ball.tch -c gc.ball -d bounce -o formulas").status == 0);
  REQUIRE(workspace.tchat("run ball -c gc.ball -d bounce -o cpp").status == 0);
  check_same_points(workspace, "formulas", "cpp");
  const double pi = std::acos(-1.0), r = 0.5;
  bool doubles = false;
  for (const SolutionEntry& solution : workspace.solutions("formulas"))
    if (solution.type == 7) {
      doubles = true;
      CHECK(solution.parameter(1) ==
            Approx(std::hypot(pi * (1 - r) / (1 + r), 2 * (1 + r * r) / ((1 + r) * (1 + r)))).epsilon(1e-8));
    }
  CHECK(doubles);
}

TEST_CASE("formulas become a folder with C++, which simulates to the same orbit") {
  const Workspace workspace;
  workspace.write("mine.tch", oscillator);
  const Outcome made = workspace.tchat("new translated --from mine.tch");
  INFO(made.text());
  REQUIRE(made.status == 0);
  CHECK(contains(workspace.read("translated/translated.cpp"), "rate[1] = alpha * y2 - 2.0 * zeta * x2 - x1;"));
  CHECK(workspace.tchat("check translated/translated").status == 0);
  check_refused(workspace.tchat("new translated --from mine.tch"), {"exists"});
  check_refused(workspace.tchat("new other --from none.tch"), {"none.tch"});
  CHECK_FALSE(workspace.has("other"));
}

TEST_CASE("formulas are compiled at the first command and not again until they change, however they are named") {
  setenv("CXX", "c++", 1);  // itself: what tests have in its place keeps libraries
  const Workspace workspace;
  workspace.write("mine.tch", oscillator);
  const auto made_by = [&](const std::string& name) {
    REQUIRE(workspace.tchat("check " + name).status == 0);
    return std::filesystem::last_write_time(workspace.file("mine.tch.so"));
  };
  const auto made = made_by("mine");
  CHECK(made_by("mine") == made);
  CHECK(made_by("mine.tch") == made);
  CHECK(made_by("./mine") == made);
  CHECK(made_by(workspace.file("mine")) == made);
  workspace.edit("mine.tch", "zeta=0.05", "zeta=0.06");
  CHECK(made_by("mine") != made);
}

TEST_CASE("mistakes in formulas are told by every command, and an edit is taken at once") {
  const Workspace workspace;
  workspace.write("mine.tch", oscillator);
  workspace.edit("mine.tch", "2*zeta*x2", "2*zeto*x2");
  for (const char* command : {"check mine", "simulate mine", "run mine -c impacting -d impacting", "check mine.tch"})
    check_refused(workspace.tchat(command), {"mine.tch:6:", "'zeto' is not known (did you mean 'zeta'?)", "^"});
  CHECK_FALSE(workspace.has("mine.tch.so"));
  workspace.edit("mine.tch", "2*zeto*x2", "2*zeta*x2*abs(x2)");
  const Outcome checked = workspace.tchat("check mine");
  CHECK(checked.status == 0);
  CHECK(contains(checked.out, "mine.tch:6:"));
  CHECK(contains(checked.out, "kink"));
}

namespace {

/// A forced mass with an elastic, damped stop at x = d.
const std::string elastic_stop = R"(
par w=1, a=0.1, z=0.05, k=20, z2=0.1, d=0.5
init x=0, v=0, s=0, c=1
x' = v
free = a*c - 2*z*v - x
s' = (1-s^2-c^2)*s + w*c
c' = (1-s^2-c^2)*c - w*s
field free
v' = free
field contact
v' = free - k*(x-d) - 2*z2*v
event touch = d - x
event leave = x - d
event top = v
after leave: free until touch -> identity, top -> identity
after touch: contact until leave -> identity
after any: free until touch -> identity, top -> identity
)";

std::vector<double> folds(const Workspace& workspace, const std::string& name) {
  std::vector<double> places;
  for (const SolutionEntry& solution : workspace.solutions(name))
    if (solution.type == 5) places.push_back(solution.parameter(1));
  return places;
}

}  // namespace

// Close to the grazing end of the branch a fold follows; with the default steps a point lands on it by chance, with a
// share of ICP(1) in its tangent that is rounding. Small steps walk over it.
TEST_CASE("elastic stop: the fold beside grazing has its label with any steps, and the end is admissible") {
  const Workspace workspace;
  workspace.write("stop.tch", elastic_stop);
  REQUIRE(workspace.tchat("simulate stop --dat hit").status == 0);
  const Outcome coarse = workspace.tchat("run stop -c hit -d hit -o coarse");
  INFO(coarse.text());
  REQUIRE(coarse.status == 0);
  REQUIRE(workspace.tchat("run stop -c hit -d hit -o fine DSMAX=0.02 NMX=400").status == 0);
  const std::vector<double> found = folds(workspace, "coarse");
  const std::vector<double> expected = folds(workspace, "fine");
  REQUIRE(expected.size() == 2);
  REQUIRE(found.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) CHECK(found[k] == Approx(expected[k]).epsilon(1e-8));
  CHECK_FALSE(contains(coarse.out, "inadmissible"));
}

TEST_CASE("switches written with the wrong sign, or reached by no line, are told") {
  const Workspace workspace;
  workspace.write("stop.tch", elastic_stop);
  workspace.edit("stop.tch", "event leave = x - d", "event leave = d - x");
  const Outcome wrong = workspace.tchat("simulate stop PAR(w)=1.5 PAR(a)=1 --dat wrong");
  INFO(wrong.text());
  CHECK(contains(wrong.out, "Event 2 (leave) is negative on segment"));
  workspace.write("stop.tch", elastic_stop);
  workspace.edit("stop.tch", "after touch: contact until leave -> identity\n", "");
  check_refused(workspace.tchat("check stop"), {"no 'after' line leads to field contact"});
  workspace.write("stop.tch", elastic_stop);
  workspace.edit("stop.tch", "z=0.05", "z=0,05");
  check_refused(workspace.tchat("check stop"), {"decimals are written with a point, as 0.05"});
}

TEST_CASE("elastic stop: a contact that changes the field alone begins a branch, with damping in contact too") {
  const Workspace workspace;
  workspace.write("stop.tch", elastic_stop);
  REQUIRE(workspace.tchat("simulate stop PAR(w)=2.5 PAR(a)=1 --dat free").status == 0);
  REQUIRE(workspace.tchat("run stop -c free -d free -o free DS=-0.02 RL0=0.3 RL1=3").status == 0);
  const Outcome born = workspace.tchat("resegment q.free GR1 --to impacting -o born -p stop NMX=30");
  INFO(born.text());
  REQUIRE(born.status == 0);
  CHECK(contains(born.out, "Segment 2 lasts no time here"));
  const Outcome run = workspace.tchat("run stop -c born -s born -o born");
  INFO(run.text());
  REQUIRE(run.status == 0);
  CHECK_FALSE(contains(run.out, "inadmissible"));
  const Outcome verified = workspace.tchat("verify q.born -p stop");
  INFO(verified.text());
  CHECK(verified.status == 0);
}

TEST_CASE("elastic stop: from grazing, the direction in which the contact would last a negative time ends at once") {
  const Workspace workspace;
  workspace.write("stop.tch", elastic_stop);
  REQUIRE(workspace.tchat("simulate stop PAR(w)=2.5 PAR(a)=1 --dat free").status == 0);
  REQUIRE(workspace.tchat("run stop -c free -d free -o free DS=-0.02 RL0=0.3 RL1=3").status == 0);
  REQUIRE(workspace.tchat("resegment q.free GR1 --to impacting -o born -p stop NMX=8").status == 0);
  int ended = 0;
  for (const std::string ds : {"0.02", "-0.02"}) {
    const Outcome run = workspace.tchat("run stop -c born -s born -o side DS=" + ds);
    INFO(run.text());
    REQUIRE(run.status == 0);
    CHECK_FALSE(contains(run.out, "inadmissible"));
    const bool is_wrong_side = contains(run.out, "the duration of segment 2 passes zero");
    CHECK(is_wrong_side ==
          contains(run.out, ds[0] == '-' ? "DS=0.02 leads the other way" : "DS=-0.02 leads the other"));
    ended += is_wrong_side;
    const Outcome on = workspace.tchat("run stop -c born -s born -o on GRSTOP=0 DS=" + ds);
    CHECK(contains(on.out, "inadmissible") == is_wrong_side);
  }
  CHECK(ended == 1);
}

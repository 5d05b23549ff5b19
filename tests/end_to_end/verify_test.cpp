// tchat verify through the binary: what passes, what is found and named, statuses, problems without optional members.
#include <fmt/format.h>

#include <filesystem>

#include "end_to_end/bad_input.hpp"

using namespace test_support;

namespace {

/// Impacting orbits, four labels.
void run_branch(const Workspace& workspace) {
  workspace.run("-c impacting -d impacting -o branch NMX=30 NTST=20 NPR=10 -q");
}

std::string line_of(const std::string& text, const std::string& beginning) {
  const std::size_t at = text.find(beginning);
  REQUIRE(at != std::string::npos);
  return text.substr(at, text.find('\n', at) - at);
}

/// The text with another fourth decimal in its `number`-th number (from 1).
std::string with_other_digit(std::string text, int number) {
  std::size_t point = 0;
  for (int k = 0; k < number; ++k) point = text.find('.', point + 1);
  char& digit = text.at(point + 4);
  digit = digit == '5' ? '4' : '5';
  return text;
}

}  // namespace

TEST_CASE("what a run has written passes, with the constants and multipliers beside it") {
  const Workspace workspace;
  run_branch(workspace);
  const Outcome outcome = workspace.tchat("verify q.branch -p linosc");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "labels agree with forward integration to 1e-06"));
  CHECK_FALSE(contains(outcome.out, "<<"));
  CHECK(outcome.err.empty());

  const Outcome one = workspace.tchat("verify branch EP1 -p linosc");
  CHECK(one.status == 0);
  CHECK(contains(one.out, "1 label agrees"));

  const Outcome quiet = workspace.tchat("verify -q q.branch -p linosc");
  CHECK(quiet.status == 0);
  CHECK(quiet.text().empty());
  CHECK(workspace.tchat("verify -q q.branch -p linosc --tolerance 1e-15").status == 1);
}

TEST_CASE("a digit changed in the q-file or the d-file is found, its label named, status 1") {
  const Workspace workspace;
  run_branch(workspace);
  const std::string solutions = workspace.read("q.branch");
  const std::size_t at_end = solutions.find("\n      1.0000000000E+000");  // of the first label
  REQUIRE(at_end != std::string::npos);
  const std::string end = solutions.substr(at_end + 1, 19 * 5);
  std::string changed = solutions;
  changed.replace(at_end + 1, end.size(), with_other_digit(end, 3));
  workspace.write("q.branch", changed);
  const Outcome state = workspace.tchat("verify q.branch -p linosc");
  INFO(state.text());
  CHECK(state.status == 1);
  CHECK(contains(line_of(state.out, "   1  EP"), "<< state"));
  CHECK_FALSE(contains(line_of(state.out, "   2  "), "<<"));
  CHECK(contains(state.out, "beyond the tolerance 1e-06: 1\n"));
  CHECK(workspace.tchat("verify -q q.branch 2 -p linosc").status == 0);
  CHECK(workspace.tchat("verify -q q.branch -p linosc").status == 1);
  workspace.write("q.branch", solutions);

  const std::string diagnostics = workspace.read("d.branch");
  const std::size_t at = diagnostics.find("   Multiplier   1");
  REQUIRE(at != std::string::npos);
  std::string with_other = diagnostics;
  with_other.replace(at, 40, with_other_digit(diagnostics.substr(at, 40), 1));
  workspace.write("d.branch", with_other);
  const Outcome multipliers = workspace.tchat("verify q.branch -p linosc");
  INFO(multipliers.text());
  CHECK(multipliers.status == 1);
  CHECK(contains(line_of(multipliers.out, "   1  EP"), "<< multipliers"));
}

TEST_CASE("a duration, a parameter and a duration without direction are found in the q-file") {
  const Workspace workspace;
  run_branch(workspace);
  const std::string solutions = workspace.read("q.branch");
  const SolutionEntry first = workspace.solutions("branch").front();
  // From 1 to 10 the 17 digits of a parameter are those of a fixed point.
  const auto verify_with = [&](double from, double to) {
    std::string changed = solutions;
    const std::string before = fmt::format("{:.16f}E+000", from);
    const std::size_t at = changed.find(before);
    REQUIRE(at != std::string::npos);
    changed.replace(at, before.size(), fmt::format("{:.16f}E+000", to));
    workspace.write("q.branch", changed);
    return workspace.tchat("verify q.branch 1 -p linosc");
  };
  const double duration = first.parameter(61), alpha = first.parameter(1);
  const Outcome longer = verify_with(duration, duration + 1e-4);
  INFO(longer.text());
  CHECK(longer.status == 1);
  CHECK(contains(line_of(longer.out, "   1  EP"), "<< state, time"));
  const Outcome backwards = verify_with(duration, -duration);
  INFO(backwards.text());
  CHECK(backwards.status == 1);
  CHECK(contains(line_of(backwards.out, "   1  EP"), "<< no positive duration"));
  const Outcome forced = verify_with(alpha, alpha + 1e-4);
  INFO(forced.text());
  CHECK(forced.status == 1);
  CHECK(contains(line_of(forced.out, "   1  EP"), "<< state"));
}

TEST_CASE("a label whose multipliers are not those of its type is found") {
  const Workspace workspace;
  run_branch(workspace);
  // "     1    10     4     2 ...": label 2 becomes a fold, a period doubling, a torus bifurcation.
  const std::string solutions = workspace.read("q.branch");
  const std::size_t at = solutions.find("\n     1    10     4     2");
  REQUIRE(at != std::string::npos);
  for (const char type : {'5', '6', '7', '8'}) {
    std::string changed = solutions;
    changed[at + 18] = type;
    workspace.write("q.branch", changed);
    const Outcome outcome = workspace.tchat("verify q.branch -p linosc");
    INFO(outcome.text());
    CHECK(outcome.status == 1);
    CHECK(contains(line_of(outcome.out, "   2  "), "<< no critical multiplier"));
    CHECK(contains(outcome.out, "beyond the tolerance 1e-06: 2\n"));
  }
}

TEST_CASE("inadmissible points pass when the run has said so, not when it has not") {
  const Workspace workspace;
  workspace.run("-c impacting -d impacting -o branch DS=-0.02 GRSTOP=0 NMX=60 NTST=20 -q");
  const Outcome told = workspace.tchat("verify q.branch -p linosc");
  INFO(told.text());
  CHECK(told.status == 0);
  CHECK(contains(told.out, "inadmissible as stored"));
  CHECK(contains(told.out, "crossed from below"));

  std::string diagnostics = workspace.read("d.branch");
  for (auto at = diagnostics.find(" inadmissible\n"); at != std::string::npos; at = diagnostics.find(" inadmissible\n"))
    diagnostics.replace(at, 13, "             ");
  workspace.write("d.branch", diagnostics);
  const Outcome silent = workspace.tchat("verify q.branch -p linosc");
  INFO(silent.text());
  CHECK(silent.status == 1);
  CHECK(contains(silent.out, "<< event"));
}

TEST_CASE("without a d-file multipliers are printed, without constants the cure is told") {
  const Workspace workspace;
  run_branch(workspace);
  std::filesystem::remove(workspace.file("d.branch"));
  const Outcome outcome = workspace.tchat("verify q.branch 1 -p linosc");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.err, "there is no d.branch"));
  CHECK(contains(outcome.out, "multipliers: "));

  std::filesystem::remove(workspace.file("r.branch"));
  check_refused(workspace.tchat("verify q.branch -p linosc"), {"r.branch", "-c"});
  CHECK(workspace.tchat("verify -q q.branch -p linosc -c impacting").status == 0);
  check_refused(workspace.tchat("verify q.branch PD7 -p linosc -c impacting"), {"PD7"});
  check_refused(workspace.tchat("verify q.branch 1x -p linosc -c impacting"), {"'1x'", "PD1"});
  check_refused(workspace.tchat("verify q.branch -c impacting"), {"branch.cpp"});
  check_refused(workspace.tchat("verify q.nosuch"), {"q.nosuch"});
  check_refused(workspace.tchat("verify q.branch -p linosc -c impacting --tolerance 0"), {"--tolerance"});
}

TEST_CASE("a label of other constants is told, not passed over") {
  const Workspace workspace;
  run_branch(workspace);
  workspace.write("gc.other", "NDIM = 4\nIPS = 150\nICP = [1, 2, 61]\nGCHIND = [1]\nGCGIND = [2]\nGCSEGTYP = [2]\n");
  const Outcome outcome = workspace.tchat("verify q.branch -p linosc -c other");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  CHECK(contains(outcome.out, "not verified: computed with IPS = 180, the constants have 150"));
}

TEST_CASE("verify needs no optional member of a problem") {
  const Workspace workspace;
  // Thrown up anew with the same velocity at each landing: T = 2 v / g; multipliers 0, 0.
  workspace.write(
      "thrown.cpp",
      "#include <tchat/problem.hpp>\n"
      "struct Thrown {\n"
      "  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;\n"
      "  template <class T> void field(int, const T* x, const T* par, T* f) const {\n"
      "    f[0] = x[1]; f[1] = -par[0];\n  }\n"
      "  template <class T> T event(int, const T* x, const T*) const { return x[0]; }\n"
      "  template <class T> void jump(int, const T*, const T* par, T* g) const { g[0] = 0; g[1] = par[1]; }\n"
      "};\nTCHAT_PROBLEM(Thrown)\n");
  workspace.write("gc.thrown",
                  "NDIM = 2\nIPS = 180\nICP = [1, 61]\nNTST = 5\nNMX = 5\nNPR = 2\nRL0 = 1\nRL1 = 100\nDS = 0.1\n"
                  "GCHGRZIND = [[1]]\n");
  workspace.write("thrown.dat", "# PAR(1) = 8\n# PAR(2) = 4\n0 0 4\n0.25 0.75 2\n0.5 1 0\n0.75 0.75 -2\n1 0 -4\n");
  REQUIRE(workspace.tchat("run thrown -q").status == 0);
  const Outcome outcome = workspace.tchat("verify thrown");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.out, "agree"));
  CHECK(contains(outcome.out, "event 1"));
}

TEST_CASE("between the labels of a curve each point has the multiplier of the curve, or is named") {
  // In polar coordinates r' = -r ((r - 2)^2 - (p - q^2)), one turn takes 2 pi: folds of orbits at p = q^2.
  const Workspace workspace;
  workspace.write("turning.tch", R"(par p=0.25, q=0.3
init x=2.4, y=0
r = sqrt(x^2 + y^2)
g = (r - 2)^2 - (p - q^2)
x' = -x*g - y
y' = -y*g + x
)");
  workspace.succeed("simulate turning --free p --dat s -q");
  workspace.succeed("run turning -c s -d s -o orbits DS=-0.02 DSMAX=.05 RL0=-.1 NMX=60 STOP=LP1");
  CHECK_FALSE(contains(workspace.succeed("verify orbits").out, "Between the labels"));  // nothing must hold there
  workspace.succeed("run turning -c r.orbits -s orbits -o folds IRS=LP1 ISW=2 ICP=[p,q] DSMAX=.1 RL0=-1 RL1=1 NMX=20");
  const Outcome right = workspace.tchat("verify folds");
  INFO(right.text());
  CHECK(right.status == 0);
  CHECK(contains(right.out, "Between the labels: "));
  CHECK(contains(right.out, "the multiplier of the curve at "));

  // Short blocks are those of points without a label.
  std::string diagnostics = workspace.read("d.folds");
  const std::size_t at = diagnostics.find("\nMultiplier 1 ");  // two: one is 1 on every orbit, along the flow
  REQUIRE(at != std::string::npos);
  const std::size_t end = diagnostics.find('\n', at + 1);
  diagnostics.replace(at, end - at, "\nMultiplier 1 5.0000000000E-01 0");
  workspace.write("d.folds", diagnostics);
  const Outcome strange = workspace.tchat("verify folds");
  INFO(strange.text());
  CHECK(strange.status == 1);
  CHECK(contains(strange.out, "1 without the multiplier of the curve to 1.0e-03"));
  CHECK(contains(strange.out, ", but points between are none of the curve."));
  CHECK(workspace.tchat("verify folds EP1").status == 0);
}

// How a branch may end or fail to begin: MX, failing first steps and first points, functions without a value, singular
// problems, orbits that violate the model.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void check_contains(const std::string& text, const std::vector<std::string>& parts) {
  INFO(text);
  for (const std::string& part : parts) {
    INFO("expected: " << part);
    CHECK(contains(text, part));
  }
}

/// The oscillator's source with one line put before `anchor`.
void write_variant(const Workspace& workspace, const std::string& name, const std::string& anchor,
                   const std::string& line) {
  std::string source = workspace.read("linosc.cpp");
  const auto at = source.find(anchor);
  REQUIRE(at != std::string::npos);
  workspace.write(name + ".cpp", source.insert(at, line + "\n    "));
}

}  // namespace

TEST_CASE("a branch that ends by MX after some steps is a result, with advice") {
  const Workspace workspace;
  // Newton needs a third iteration once the step has grown, and may not make the step smaller.
  const Outcome outcome =
      workspace.run("-c impacting -d impacting -o branch ITNW=2 ICP=[omega,61] RL0=0.1 DS=-0.02 DSMIN=0.019 DSMAX=5");
  const auto sections = workspace.points("branch");
  REQUIRE(sections.front().rows.size() > 2);
  CHECK(sections.front().rows.back().type == -9);
  CHECK(workspace.solutions("branch").back().type == -9);
  CHECK(workspace.solutions("branch").back().label == sections.front().rows.back().label);
  check_contains(outcome.out, {"MX", "no convergence", "tried", "you might", "DSMIN", "NTST"});
  check_contains(workspace.read("d.branch"), {"MX", "NOTE: Retrying step", "NOTE: No convergence"});
  // On from there with the constants that help.
  workspace.run("-c impacting -s branch -o on IRS=MX1 NMX=3");
}

TEST_CASE("MX after a new mesh: the last point once more, a restart needs one Newton step at most") {
  const Workspace workspace;
  workspace.run(
      "-c impacting -d impacting -o branch ITNW=2 ICP=[omega,61] RL0=0.1 DS=-0.02 DSMIN=0.019 DSMAX=5 NPR=1 IAD=1 "
      "NTST=10");
  const std::vector<SolutionEntry> solutions = workspace.solutions("branch");
  REQUIRE(solutions.size() > 3);
  REQUIRE(solutions.back().type == -9);
  const SolutionEntry& last = solutions[solutions.size() - 2];
  CHECK(solutions.back().t == last.t);
  CHECK(solutions.back().states == last.states);
  CHECK(solutions.back().direction == last.direction);
  workspace.run("-c impacting -s branch -o again IRS=MX1 NMX=1 IAD=1 NTST=10");
  const std::string text = workspace.read("d.again");
  const auto at = text.find("Iterations   :");
  REQUIRE(at != std::string::npos);
  CHECK(std::stoi(text.substr(at + 14)) <= 1);
}

TEST_CASE("with --strict a branch that ends by MX has exit status 3") {
  const Workspace workspace;
  const std::string fails =
      "run linosc -c impacting -d impacting -o branch ITNW=2 ICP=[omega,61] RL0=0.1 DS=-0.02 DSMIN=0.019 DSMAX=5";
  CHECK(workspace.tchat(fails).status == 0);
  const Outcome strict = workspace.tchat(fails + " --strict");
  CHECK(strict.status == 3);
  check_contains(strict.err, {"MX", "steps down to"});
  CHECK(workspace.points("branch").front().rows.back().type == -9);
  check_contains(workspace.read("d.branch"), {"end of run"});
  CHECK(workspace.tchat("run linosc -c impacting -d impacting -o branch NMX=5 --strict").status == 0);
}

TEST_CASE("a branch of doubled orbits ends where it leads on along those that it was born from") {
  const Workspace workspace;
  // Roessler's equations: period doublings at c = 2.832 and 3.837. On this mesh the branch does not turn at the latter.
  workspace.write(
      "roessler.tch",
      "par c=3.9\nnumber a=0.2, b=0.2\ninit x=7.888402113507169, y=-1.9456860628051516, z=1.945686062805151\n"
      "x' = -y - z\ny' = x + a*y\nz' = b + z*(x - c)\n");
  REQUIRE(workspace.tchat("simulate roessler --mode 1,1,2 --free c -o doubled --dat -q").status == 0);
  const Outcome outcome =
      workspace.tchat("run roessler -c doubled -d doubled -o doubled ICP=[c] RL0=3.5 DS=-0.018 DSMAX=0.18 NMX=60");
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  check_contains(outcome.out, {"are those of half of the period, run twice"});
  const auto rows = workspace.points("doubled").front().rows;
  CHECK(rows.front().values.front() == Approx(3.9));
  CHECK(rows.back().values.front() > 3.7);
}

TEST_CASE("a first step that fails") {
  const Workspace workspace;
  const Outcome outcome =
      workspace.tchat("run linosc -c impacting -d impacting -o branch DSMIN=0.4 DS=0.5 DSMAX=5 ITNW=2");
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"first step"});
  check_contains(outcome.out, {"MX", "you might"});
  CHECK(workspace.points("branch").front().rows.back().type == -9);
  const Outcome fixed = workspace.tchat("run linosc -c impacting -d impacting -o fixed IADS=0 DS=0.5 DSMAX=5 ITNW=2");
  CHECK(fixed.status == 1);
  check_contains(workspace.read("d.fixed"), {"No convergence with fixed step size"});
}

TEST_CASE("no convergence at the first point: the residual of every condition by name, no files") {
  const Workspace workspace;
  // An orbit that is far from any: it does not close.
  workspace.write("wrong.dat", "# PAR(61) = 3\n0 1 -5 0 1\n0.5 -40 90 1 0\n1 7 3 20 -9\n");
  const Outcome outcome = workspace.tchat("run linosc -c impacting -d wrong -o branch ITNW=3");
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"wrong.dat", "no convergence at the first point", "differential equations on segment 1",
                               "wall", "x1 at the start of segment 1", "y2 at the start of segment 1", "impact"});
  for (const char* file : {"p.branch", "q.branch", "d.branch", "r.branch"}) CHECK_FALSE(workspace.has(file));
}

TEST_CASE("a curve whose condition holds at every point is refused") {
  const Workspace workspace;
  const std::string free_of_wall = " GCHGRZIND=[[]] GCIPSI=[] UZR={omega:1.7}";
  workspace.run("-c nonimpacting_alpha -d nonimpacting -o slower ICP=[omega,61] RL0=1 RL1=3 DS=-0.1 PAR(alpha)=0.5" +
                free_of_wall);
  workspace.run("-c r.slower -s slower -o undamped IRS=UZ1 ICP=[zeta,61] RL0=-0.1 RL1=0.2 DS=-0.01 DSMAX=0.02 UZR={}");
  // Without damping all multipliers have size 1, whatever the force is.
  const std::string from_torus = "run linosc -c r.undamped -s undamped IRS=TR1 ISW=2 RL0=1 RL1=3 DS=0.01 NMX=3 ";
  const Outcome outcome = workspace.tchat(from_torus + "-o nowhere ICP=[omega,alpha,61]");
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"singular", "omega, alpha undetermined"});
  CHECK_FALSE(workspace.has("p.nowhere"));
  const Outcome curve = workspace.tchat(from_torus + "-o curve ICP=[omega,zeta,61]");
  CHECK(curve.status == 0);
  for (const PointRow& row : rows_of(workspace.points("curve"))) CHECK(std::abs(row.values.at(6)) < 1e-9);  // zeta
}

TEST_CASE("Newton that falls to an orbit of zero period is no start") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat("run linosc -c impacting -d impacting -o branch NTST=1 NCOL=2");
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"impacting.dat", "period", "NTST"});
  CHECK_FALSE(workspace.has("p.branch"));
}

TEST_CASE("a function that loses its value on the way is named where the branch ends") {
  const Workspace workspace(Workspace::Plugin::source);
  write_variant(workspace, "cliff", "const T radius2", "if (alpha > 3.1) { f[0] = NAN; return; }");
  const Outcome outcome = workspace.tchat("run cliff -c impacting -d impacting -o branch DSMIN=1e-4");
  INFO(outcome.text());
  CHECK(outcome.status == 0);
  check_contains(outcome.out,
                 {"MX", "free flight", "alpha = 3.0999", "see above", "RL0, RL1", "let the model give a value"});
  CHECK(outcome.out.find("not finite") == outcome.out.rfind("not finite"));  // told once
  CHECK_FALSE(contains(outcome.out, "NTST"));                                // no mesh helps
  const auto rows = workspace.points("branch").front().rows;
  REQUIRE(rows.size() > 3);
  CHECK(rows.back().type == -9);
  CHECK(rows.back().values.front() <= 3.1);
  CHECK(rows.back().values.front() > 3.09);
}

TEST_CASE("a function without a value at the start is named") {
  const Workspace workspace(Workspace::Plugin::source);
  write_variant(workspace, "hole", "const T radius2", "if (x[0] < 0.0) { f[1] = NAN; return; }");
  const Outcome outcome = workspace.tchat("run hole -c impacting -d impacting -o branch");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"impacting.dat", "free flight", "x1"});
  CHECK_FALSE(workspace.has("p.branch"));
}

TEST_CASE("an output that a function forgets is found") {
  const Workspace workspace(Workspace::Plugin::source);
  write_variant(workspace, "forgetful", "const T radius2", "if (true) { f[0] = x[1]; f[2] = f[3] = x[0]; return; }");
  const Outcome outcome = workspace.tchat("run forgetful -c impacting -d impacting -o branch");
  INFO(outcome.text());
  CHECK((outcome.status == 1 || outcome.status == 2));
  check_contains(outcome.err, {"free flight"});
}

TEST_CASE("a singular problem is refused with the undetermined state named") {
  const Workspace workspace;
  workspace.write("idle.cpp", R"(#include <tchat/problem.hpp>
// A forced oscillator with a state that nothing moves and no jump sets.
struct Idle {
  static constexpr int dimension = 3, parameters = 1, fields = 1, events = 1, jumps = 1;
  static constexpr const char* state_names[] = {"position", "velocity", "bystander"};
  static constexpr const char* parameter_names[] = {"mu"};
  static constexpr double initial_parameters[] = {1.0};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T radius2 = x[0] * x[0] + x[1] * x[1];
    f[0] = x[0] * (par[0] - radius2) + x[1];
    f[1] = x[1] * (par[0] - radius2) - x[0];
    f[2] = 0.0 * x[0];
  }
  template <class T>
  T event(int, const T* x, const T*) const { return x[1]; }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const { for (int i = 0; i < 3; ++i) g[i] = x[i]; }
};
TCHAT_PROBLEM(Idle)
)");
  // From a maximum of the velocity's sign change: the unit circle, clockwise from (-1, 0).
  std::string data;
  for (int k = 0; k <= 40; ++k) {
    const double angle = 2.0 * M_PI * k / 40;
    data += fmt::format("{:.17g} {:.17g} {:.17g} 0.25\n", angle, std::cos(angle), -std::sin(angle));
  }
  workspace.write("idle.dat", data);
  workspace.write("gc.idle",
                  "NDIM = 3\nIPS = 180\nICP = [1, 61]\nNTST = 20\nNCOL = 4\nNMX = 5\nRL0 = 0\nRL1 = 2\n"
                  "GCNOSEG = 1\nGCFIND = [1]\nGCHIND = [1]\nGCGIND = [1]\n");
  const Outcome outcome = workspace.tchat("run idle");
  INFO(outcome.text());
  CHECK(outcome.status == 1);
  check_contains(outcome.err, {"singular", "bystander on segment 1"});
  CHECK_FALSE(contains(outcome.err, "velocity on segment"));
  CHECK_FALSE(workspace.has("p.idle"));
}

TEST_CASE("orbits that violate the model are marked where they begin") {
  const Workspace workspace;
  const Outcome outcome = workspace.run("-c impacting -d impacting -o branch DS=-0.02 NMX=20 GRSTOP=0");
  check_contains(outcome.out, {"inadmissible", "wall", "violate the model"});
  const std::string diagnostics = workspace.read("d.branch");
  check_contains(diagnostics, {"inadmissible", "NOTE: Inadmissible: ", "wall"});
  // The branch that stays outside the wall is not.
  const Outcome fine = workspace.run("-c impacting -d impacting -o fine NMX=10");
  CHECK_FALSE(contains(fine.out, "inadmissible"));
  CHECK_FALSE(contains(workspace.read("d.fine"), "nadmissible"));
}

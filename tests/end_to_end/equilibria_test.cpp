// Equilibria (IPS = 1) by the executable: closed forms, restarts, periodic orbits from Hopf points, what is refused.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

/// EPSL = EPSU = 1e-11, special points to EPSS = 1e-10 of arclength; q-files hold 11 digits of states.
constexpr double accuracy = 1e-9;
constexpr double pi = 3.14159265358979323846;

/// Circles x^2 + y^2 = p1 of period pi around x = y = 0, beside z' = p2 - z. Section 1 goes through their centre.
const char* const source = R"(#include <tchat/problem.hpp>
struct Round {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 4, jumps = 2;
  static constexpr double initial_parameters[] = {-0.53, 0.5};
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T growth = p[0] - x[0] * x[0] - x[1] * x[1];
    f[0] = growth * x[0] - T(2.0) * x[1];
    f[1] = T(2.0) * x[0] + growth * x[1];
    f[2] = p[1] - x[2];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    if (j == 1) return x[1];
    if (j == 2) return x[1] - T(1.0);
    return j == 3 ? x[2] - p[1] : T(0.4) - p[0];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = k == 1 ? x[i] : -x[i];
  }
};
TCHAT_PROBLEM(Round)
)";

void write_round(const Workspace& workspace) {
  workspace.write("round.cpp", source);
  workspace.write("gc.round",
                  "NDIM = 3, IPS = 1, ICP = [1]\nNMX = 60, RL0 = -2, RL1 = 1, DS = 0.05, DSMAX = 0.2\nEPSL = 1e-11, "
                  "EPSU = 1e-11, EPSS = 1e-10\n");
  workspace.write("round.dat", "# PAR(1) = -0.53\n0 0 0.5\n");
}

const std::string to_cycles = "run round -s round -q IRS=HB1 IPS=180 ISW=-1 NTST=40 ";

void check_done(const Outcome& outcome) {
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
}

void check_refused(const Workspace& workspace, const std::string& arguments, const std::vector<std::string>& parts) {
  const Outcome outcome = workspace.tchat(arguments);
  INFO(arguments << '\n' << outcome.text());
  CHECK(outcome.status != 0);
  CHECK(outcome.signal == 0);
  for (const std::string& part : parts) {
    INFO("expected: " << part);
    CHECK(outcome.err.find(part) != std::string::npos);
  }
}

SolutionEntry of_type(const std::vector<SolutionEntry>& entries, int type) {
  for (const SolutionEntry& entry : entries)
    if (entry.type == type) return entry;
  FAIL("no label of type " << type);
  throw std::logic_error("");
}

}  // namespace

TEST_CASE("an equilibrium is stored as one point, and a restart from it goes on") {
  const Workspace workspace;
  write_round(workspace);
  check_done(workspace.tchat("run round -q"));
  const auto entries = workspace.solutions("round");
  const SolutionEntry hopf = of_type(entries, 3);
  CHECK(hopf.t == std::vector<double>{0.0});
  CHECK(hopf.intervals == 1);
  CHECK(hopf.collocation == 0);
  CHECK(hopf.problem_type == 1);
  CHECK(std::abs(hopf.parameter(1)) < accuracy);
  for (const PointRow& row : rows_of(workspace.points("round")))
    if (row.type == 0) CHECK((row.point < 0) == (row.values.at(0) < 0.0));

  check_done(workspace.tchat("run round -s round -q -o on IRS=HB1 UZR={1:0.3}"));
  const SolutionEntry value = of_type(workspace.solutions("on"), -4);
  CHECK(std::abs(value.parameter(1) - 0.3) < accuracy);
  const std::string labels = workspace.tchat("labels q.round").out;
  CHECK(labels.find("Hopf bifurcation, omega = 2, period 3.14159265") != std::string::npos);
}

TEST_CASE("periodic orbits begin at a Hopf bifurcation, with a section and without") {
  const Workspace workspace;
  write_round(workspace);
  check_done(workspace.tchat("run round -q"));
  const std::string signature = GENERATE("GCHIND=[0] GCGIND=[0]", "GCHIND=[1] GCGIND=[1]", "GCHIND=[1] GCGIND=[0]");
  const std::string step = GENERATE("DS=0.1", "DS=-0.02");
  check_done(workspace.tchat(to_cycles + signature + " " + step + " -o cycles UZR={-1:0.25}"));
  const auto entries = workspace.solutions("cycles");
  const SolutionEntry orbit = of_type(entries, -4);
  CHECK(std::abs(orbit.parameter(1) - 0.25) < accuracy);
  CHECK(std::abs(orbit.parameter(61) - pi) < accuracy);
  // The collocation polynomials at mesh points; EPSS leaves sqrt(p1) to 1e-10.
  for (std::size_t k = 0; k < orbit.t.size(); k += 4)
    CHECK(std::abs(std::hypot(orbit.states[k][0], orbit.states[k][1]) - 0.5) < accuracy);
  if (signature.find("GCHIND=[1]") != std::string::npos) {
    CHECK(std::abs(orbit.states.back()[1]) < accuracy);
    CHECK(orbit.states.back()[0] < 0.0);  // the event function falls there: y' = 2 x
  }
}

TEST_CASE("a branch of periodic orbits that shrinks onto an equilibrium ends with HB") {
  const Workspace workspace;
  write_round(workspace);
  check_done(workspace.tchat("run round -q"));
  const std::string signature = GENERATE("GCHIND=[0] GCGIND=[0]", "GCHIND=[1] GCGIND=[1]");
  check_done(workspace.tchat(to_cycles + signature + " DS=0.1 -o cycles UZR={-1:0.25}"));
  const Outcome back = workspace.tchat("run round -c r.cycles -s cycles -o back IRS=UZ1 ISW=1 DS=-0.1 UZR={}");
  check_done(back);
  CHECK(back.out.find("the orbit has shrunk to a point") != std::string::npos);
  CHECK(back.out.find("Hopf bifurcation, omega = 2)") != std::string::npos);
  const SolutionEntry end = workspace.solutions("back").back();
  CHECK(end.type == 3);
  CHECK(std::abs(end.parameter(1)) < 1e-6);
  check_refused(workspace, "run round -s back -o e IRS=HB1 IPS=180 ISW=-1 GCHIND=[0] GCGIND=[0]",
                {"a branch of orbits has shrunk to a point", "IPS = 1"});
}

TEST_CASE("a boundary equilibrium is labelled BE, in every file and by IRS") {
  const Workspace workspace;
  write_round(workspace);
  const Outcome run = workspace.tchat("run round GCHGRZIND=[[4]]");
  check_done(run);
  CHECK(run.err.empty());
  CHECK(run.out.find("BE label 3 at PAR(1) = 0.4") != std::string::npos);
  const SolutionEntry contact = of_type(workspace.solutions("round"), -4);
  CHECK(std::abs(contact.parameter(1) - 0.4) < accuracy);
  CHECK(contact.internal == std::vector<double>{7, 1, 4, 0});
  CHECK(workspace.tchat("labels q.round").out.find("boundary equilibrium: contact with event 4") != std::string::npos);
  const Outcome beyond = workspace.tchat("run round -s round -o beyond IRS=BE1 GCHGRZIND=[[4]] GRSTOP=0");
  check_done(beyond);
  CHECK(beyond.out.find("at the equilibrium") != std::string::npos);
  CHECK(beyond.out.find("violate the model") != std::string::npos);
}

TEST_CASE("what is no Hopf point, or no start of its periodic orbits, is refused") {
  const Workspace workspace;
  write_round(workspace);
  check_done(workspace.tchat("run round -q"));
  check_refused(workspace, to_cycles + "-o e GCHIND=[0] GCGIND=[0] PAR(1)=0.3",
                {"q.round: label 2 is a Hopf point that is none", "0.3 + 2 i"});
  check_refused(workspace, to_cycles + "-o e GCHIND=[2] GCGIND=[0]",
                {"do not meet the section", "event 2", "is -1 at the equilibrium", "choose a section"});
  check_refused(workspace, to_cycles + "-o e GCHIND=[3] GCGIND=[0]", {"lies in the section of event function 3"});
  check_refused(workspace, to_cycles + "-o e GCHIND=[1] GCGIND=[2]", {"jump 2", "is not the identity"});
  check_refused(workspace, to_cycles + "-o e GCFIND=[1,1] GCHIND=[1,1] GCGIND=[1,1]", {"the signature has 2 segments"});
  check_refused(workspace, "run round -s round -o e IRS=EP1 IPS=180 ISW=-1 GCHIND=[0] GCGIND=[0]",
                {"ISW = -1 switches at", "Hopf bifurcation of equilibria (HB)"});
  check_refused(workspace, "run round -s round -o e IRS=HB1 IPS=180 GCHIND=[0] GCGIND=[0]",
                {"label 2 is an equilibrium, not an orbit", "ISW = -1"});
  check_refused(workspace, "run round -s round -o e IRS=EP1 ISW=-1", {"ISW = -1 switches at a branch point (BP)"});
  check_refused(workspace, "run round -s round -o e IRS=EP1 ISW=2 ICP=[1,2]",
                {"Hopf bifurcations of equilibria", "a label of type EP"});
  check_refused(workspace, "run round -s round -o e IRS=HB1 ISW=2", {"at least 2 with IPS = 1, ISW = 2"});
  CHECK_FALSE(workspace.has("q.e"));
}

TEST_CASE("constants and data that are none of an equilibrium are refused") {
  const Workspace workspace;
  write_round(workspace);
  check_refused(workspace, "run round GCHIND=1", {"GCHIND(1)", "nothing ends a segment"});
  check_refused(workspace, "run round GCFIND=[1,1] GCHIND=[0,0] GCGIND=[0,0]",
                {"GCNOSEG", "one state of one vector field"});
  check_refused(workspace, "run round GCHGRZIND=[[5]]", {"GCHGRZIND of segment 1 is 5", "4 event functions"});
  workspace.write("two.dat", "0 0 0 0\n1 0 0 0\n");
  check_refused(workspace, "run round -d two", {"two.dat:2: a second row", "one line with its states"});
  workspace.write("few.dat", "0 0\n");
  check_refused(workspace, "run round -d few", {"few.dat:1: found 2 numbers", "the 3 states of an equilibrium"});
  workspace.write("none.dat", "# nothing\n");
  check_refused(workspace, "run round -d none", {"none.dat: no row of data"});
  workspace.write("word.dat", "0 0 x\n");
  check_refused(workspace, "run round -d word", {"word.dat:1: 'x' is not a finite number"});

  // x' = 1 + x^2 + p^2 has none.
  workspace.write(
      "no.cpp",
      "#include <tchat/problem.hpp>\nstruct No {\n  static constexpr int dimension = 1, parameters = 1, "
      "fields = 1;\n  template <class T>\n  void field(int, const T* x, const T* p, T* f) const {\n    f[0] "
      "= T(1.0) + x[0] * x[0] + p[0] * p[0];\n  }\n};\nTCHAT_PROBLEM(No)\n");
  workspace.write("gc.no", "NDIM = 1, IPS = 1, ICP = [1]\n");
  workspace.write("no.dat", "0.3\n");
  check_refused(
      workspace, "run no",
      {"no convergence at the first point, from no.dat", "rate of U(1)", "There may be no equilibrium near the start"});
}

TEST_CASE("other commands say of an equilibrium that it is one") {
  const Workspace workspace;
  write_round(workspace);
  check_done(workspace.tchat("run round -q"));
  check_refused(workspace, "verify q.round", {"these are equilibria (IPS = 1)", "eigenvalues are in the d-file"});
  check_refused(workspace, "resegment q.round HB1 --to impacting -o e", {"is an equilibrium (IPS = 1)"});
  check_refused(workspace, "plot q.round HB1 -o e.png", {"label 2 is an equilibrium, not an orbit"});
  check_done(workspace.tchat("orbit q.round HB1"));
  check_done(workspace.tchat("dat round -o made"));
  check_done(workspace.tchat("run round -s made -o from_made IRS=1 -q"));
  const Outcome table = workspace.tchat("table p.round");
  check_done(table);
  CHECK(table.out.find("multiplier1_re") != std::string::npos);
}

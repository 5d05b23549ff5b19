// Every command on problems that have no optional member: a C++ class with nothing but sizes, fields, events and jumps,
// and Fortran subroutines without GCSTPNT, which do not even say their sizes. The forced linear oscillator with a wall.
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/closed_forms.hpp"

using namespace test_support;

namespace {

/// PAR(1..2) = alpha, omega; events: the wall 1 - x1, a maximum of x1; jumps: impact, identity.
const char* const cpp_source = R"(#include <tchat/problem.hpp>

struct Oscillator {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 2, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = par[0] * x[3] - 0.1 * x[1] - x[0];
    f[2] = growth * x[2] + par[1] * x[3];
    f[3] = growth * x[3] - par[1] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? T(1.0 - x[0]) : x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -0.8 * x[1];
  }
};
TCHAT_PROBLEM(Oscillator)
)";

const char* const fortran_source = R"(      SUBROUTINE GCFUNC(N,X,PAR,IDIFF,F,FX,FP,FXX,FXP,I)
      INTEGER N,IDIFF,I
      DOUBLE PRECISION X(N),PAR(*),F(N),GROWTH
      DOUBLE PRECISION FX(N,N),FP(N,*),FXX(N,N,N),FXP(N,N,*)
      GROWTH=1.0D0-X(3)**2-X(4)**2
      F(1)=X(2)
      F(2)=PAR(1)*X(4)-0.1D0*X(2)-X(1)
      F(3)=GROWTH*X(3)+PAR(2)*X(4)
      F(4)=GROWTH*X(4)-PAR(2)*X(3)
      END
      SUBROUTINE GCBOUND(N,X,PAR,IDIFF,H,HX,HP,HXX,HXP,J)
      INTEGER N,IDIFF,J
      DOUBLE PRECISION X(N),PAR(*),H,HX(N),HP(*),HXX(N,N),HXP(N,*)
      H=1.0D0-X(1)
      IF (J.EQ.2) H=X(2)
      END
      SUBROUTINE JUMPMAP(N,X,PAR,G,R,GX,GP,K)
      INTEGER N,K,L
      DOUBLE PRECISION X(N),PAR(*),G(N),R,GX(N,N),GP(N,*)
      R=0.8D0
      DO L=1,N
        G(L)=X(L)
      END DO
      IF (K.EQ.1) G(2)=-R*X(2)
      END
)";

const char* const constants = R"(NDIM = 4, IPS = 180, IRS = 0, ICP = [1, 61], NTST = 20, NMX = 30
RL1 = 3.5, DS = 0.02, DSMAX = 0.1, EPSL = 1e-9, EPSU = 1e-9, EPSS = 1e-8, GCIDIFF = 0
GCFIND = [1], GCHIND = [2], GCGIND = [2], GCSEGTYP = [0], GCHGRZIND = [[1]], GCIPSI = [1]
)";

constexpr double omega = 2.0, zeta = 0.05;

/// alpha of the response with amplitude 1, which grazes.
double amplitude_one(double frequency) { return 1.0 / amplitude(1.0, frequency, zeta); }

std::string start_data() {
  const NonimpactingOrbit orbit(2.9, omega, zeta);
  std::string text = "# PAR(1) = 2.9\n# PAR(2) = 2\n";
  for (int k = 0; k <= 100; ++k) {
    const double time = orbit.period() * k / 100;
    text += std::to_string(time);
    for (const double x : orbit.at(time)) text += ' ' + std::to_string(x);
    text += '\n';
  }
  return text;
}

class MinimalProblem {
 public:
  explicit MinimalProblem(const std::string& kind) {
    workspace.write("minimal." + kind, kind == "f" ? fortran_source : cpp_source);
    workspace.write("gc.minimal", constants);
    workspace.write("minimal.dat", start_data());
  }

  /// Fails the test unless the exit status is 0.
  Outcome tchat(const std::string& arguments) const {
    Outcome outcome = workspace.tchat(arguments);
    INFO(arguments << '\n' << outcome.text());
    REQUIRE(outcome.signal == 0);
    REQUIRE(outcome.status == 0);
    return outcome;
  }

  /// PAR(1) of the first point.
  double first_alpha(const std::string& name) const {
    const PointSection section = workspace.points(name).front();
    return section.rows.front().values[section.column("PAR(1)")];
  }

  const Workspace workspace;
};

}  // namespace

TEST_CASE("a problem without any optional member: run, check, dat, labels, orbit, verify, constants, plot") {
  for (const std::string kind : {"cpp", "f"}) {
    CAPTURE(kind);
    const MinimalProblem minimal(kind);
    minimal.tchat("check minimal PAR(1)=2.9 PAR(2)=2 --state 0.5,0.1,0,1");
    minimal.tchat("run minimal");
    const SolutionEntry grazing = minimal.workspace.solutions("minimal").back();
    CHECK(std::abs(grazing.parameter(1) - amplitude_one(omega)) < 1e-6);
    minimal.tchat("dat minimal");
    minimal.tchat("run minimal -s minimal -o again IRS=1 NMX=2");
    minimal.tchat("run minimal -o grazing");
    CHECK(contains(minimal.tchat("labels q.grazing").out, "PAR(1) = 3.006"));
    CHECK(contains(minimal.tchat("orbit q.grazing GR1").out, "U(1)"));
    minimal.tchat("verify grazing -p minimal");
    minimal.tchat("constants minimal");
    minimal.tchat("constants minimal -e");
    minimal.tchat("plot p.grazing -o branch.svg");
    minimal.tchat("plot q.grazing GR1 -p minimal -o orbit.svg");
    minimal.tchat("plot --time q.grazing GR1 -p minimal -o series.svg");
    minimal.tchat("plot --multipliers q.grazing -o multipliers.svg");
  }
}

TEST_CASE("a problem without any optional member: simulate with a signature, from a label, to an orbit") {
  for (const std::string kind : {"cpp", "f"}) {
    CAPTURE(kind);
    const MinimalProblem minimal(kind);
    // Without successors nothing is watched but the signature, given or of the constants file.
    minimal.tchat("simulate minimal --signature 1,2,2 PAR(1)=2.9 PAR(2)=2 --state 0,0,0,1 --events 5");
    CHECK(contains(minimal.tchat("simulate minimal PAR(1)=2.9 PAR(2)=2 --state 0,0,0,1 --dat found -o motion").out,
                   "found.dat"));
    minimal.tchat("plot motion.trajectory -o motion.svg");
    minimal.tchat("run minimal -c found -d found -o found1 NMX=2");
    CHECK(std::abs(minimal.first_alpha("found1") - 2.9) < 1e-9);
    minimal.tchat("verify found1 -p minimal");
    minimal.tchat("simulate minimal --signature 1,1,1;1,2,2 -s found1 IRS=1 --events 3");
    const Outcome unsaid = minimal.workspace.tchat("simulate minimal -c nowhere --state 0,0,0,1");
    CHECK(unsaid.status == 2);
  }
}

TEST_CASE("a problem without any optional member: resegment to every kind, and the runs from there") {
  for (const std::string kind : {"cpp", "f"}) {
    CAPTURE(kind);
    const MinimalProblem minimal(kind);
    minimal.tchat("run minimal -o grazing");
    const auto resegment = [&](const std::string& arguments) {
      minimal.tchat("resegment " + arguments + " -p minimal NMX=3");
    };
    const auto run = [&](const std::string& name) {
      minimal.tchat("run minimal -c " + name + " -s " + name + " -o " + name + "1");
      const SolutionEntry start = minimal.workspace.solutions(name).front();
      CHECK(std::abs(start.parameter(1) - amplitude_one(start.parameter(2))) < 1e-6);
      CHECK(std::abs(minimal.first_alpha(name + "1") - start.parameter(1)) < 1e-6);
      minimal.tchat("verify " + name + " -p minimal");
      minimal.tchat("verify " + name + "1 -p minimal --tolerance 1e-5");
    };
    resegment("q.grazing GR1 --to grazing-curve -o curve ICP=[1,2,61]");
    run("curve");
    resegment("q.grazing GR1 --to impacting -o born");
    run("born");
    CHECK_FALSE(contains(minimal.workspace.read("d.born1"), "Inadmissible"));
    resegment("q.curve1 EP1 --to impacting -o born_on_curve");
    run("born_on_curve");
    resegment("q.grazing GR1 --to signature --signature 1,2,2 -o same");
    run("same");
    resegment("q.grazing GR1 --to rotate -o rotated");
    run("rotated");
    resegment("q.grazing GR1 --to double -o doubled");
    run("doubled");
  }
}

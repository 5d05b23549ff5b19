// tchat sweep against closed forms, `tchat run`, `tchat simulate` (CVODES, another integrator than the sweep's), and on
// problems in every language.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "end_to_end/bad_input.hpp"
#include "simulate/sweep_file.hpp"

using namespace test_support;

namespace {

tchat::SweepTable sweep(const Workspace& workspace, const std::string& arguments, const std::string& output) {
  const Outcome outcome = workspace.tchat("sweep " + arguments + " -o " + output);
  INFO(outcome.text());
  REQUIRE(outcome.status == 0);
  return tchat::read_sweep_file(workspace.file(output + ".sweep"));
}

const std::vector<double>& column(const tchat::SweepTable& table, const std::string& name) {
  INFO("column " << name);
  REQUIRE(table.column(name) != nullptr);
  return *table.column(name);
}

/// Impact velocities of the orbits with one impact per forcing period at (alpha, omega): roots of a quadratic, from the
/// linear solution between impacts: q(0) = q(T) = 1, v(0) = -r v(T), and forcing of free phase.
std::vector<double> impact_velocities(double alpha, double omega, double zeta, double r) {
  // q = A(phase) + homogeneous; with period T the homogeneous part a e^{-zeta t} cos + b e^{-zeta t} sin is linear in
  // v = v(T): solved for unit v, the particular part then has amplitude rho with |1 - q_h(0)|, |...|.
  const double period = 2.0 * M_PI / omega, wd = std::sqrt(1.0 - zeta * zeta);
  const double e = std::exp(-zeta * period), c = std::cos(wd * period), s = std::sin(wd * period);
  // h(t) = e^{-zeta t}(a cos + b sin), h(T) = h(0) = a since q(0) = q(T); h'(0) - h'(T) = -(1 + r) v.
  // a (1 - e c) = b e s  and  h'(0) = -zeta a + wd b, h'(T) = e(-zeta(a c + b s) + wd(b c - a s)).
  const double b_per_a = (1.0 - e * c) / (e * s);
  const double slope0 = -zeta + wd * b_per_a;
  const double slope1 = e * (-zeta * (c + b_per_a * s) + wd * (b_per_a * c - s));
  const double a_per_v = -(1.0 + r) / (slope0 - slope1);
  // particular p(0) = 1 - a, p'(0) = v - h'(T) on the ellipse p^2 + (p'/omega)^2 = amplitude^2.
  const double size2 = alpha * alpha / (std::pow(1.0 - omega * omega, 2) + std::pow(2.0 * zeta * omega, 2));
  const double k = (1.0 - slope1 * a_per_v) / omega;
  const double A = a_per_v * a_per_v + k * k, B = -2.0 * a_per_v, C = 1.0 - size2;
  std::vector<double> velocities;
  const double root = std::sqrt(B * B - 4.0 * A * C);
  for (const double v : {(-B - root) / (2.0 * A), (-B + root) / (2.0 * A)})
    if (v > 0.0) velocities.push_back(v);
  return velocities;
}

}  // namespace

TEST_CASE("sweep: a motion that hovers over a focus, as far as integration resolves it, rests there") {
  const Workspace workspace;
  workspace.write(
      "fhn.tch",
      "par I=0, a=0.7, b=0.8, eps=0.08\ninit v=-1, w=-0.5\nv' = v - v^3/3 - w + I\nw' = eps*(v + a - b*w)\n");
  // Foci from I = 0.1 on, stable up to the Hopf bifurcation at 0.3313.
  const tchat::SweepTable table = sweep(workspace, "fhn --over I=0.2:0.32:25", "focus");
  for (const tchat::AttractorKind kind : table.kinds) CHECK(kind == tchat::AttractorKind::rest);
  CHECK(table.attractors.size() == 1);
}

TEST_CASE("sweep: a motion that begins at rounding settles, however far it has grown") {
  const Workspace workspace;
  workspace.write("bautin.tch",
                  "par mu=0.1, om=3\ninit x=1, y=0\nR = x^2 + y^2\nx' = x*(mu + R - R^2) - om*y\n"
                  "y' = y*(mu + R - R^2) + om*x\n");
  const tchat::SweepTable table = sweep(workspace, "bautin --over mu=0.1:0.5:3 --state 1e-30,0", "cycle");
  for (const tchat::AttractorKind kind : table.kinds) CHECK(kind == tchat::AttractorKind::periodic);
}

TEST_CASE("sweep: hysteresis of the impact oscillator, velocities and folds in closed form") {
  const Workspace workspace(Workspace::Plugin::source);
  const double omega = 1.8901, zeta = 0.05, r = 0.8;
  const tchat::SweepTable table =
      sweep(workspace, "linosc --over alpha=1.9:2.7:81 PAR(omega)=1.8901 --follow both --section 1", "hysteresis");
  // the impacting orbit ends in a fold at 1.9706026714368, the other one in grazing
  const double grazing = std::sqrt(std::pow(1.0 - omega * omega, 2) + std::pow(2.0 * zeta * omega, 2));
  const double fold = 1.9706026714368;
  const auto &alpha = column(table, "alpha"), &start = column(table, "start"), &x2 = column(table, "x2"),
             &impacts = column(table, "impacts"), &attractor = column(table, "attractor");
  std::map<std::pair<double, double>, bool> is_impacting;
  int compared = 0;
  std::set<double> numbers_of_impacting;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const bool impacting = impacts[i] == 1.0;
    is_impacting[{start[i], alpha[i]}] = impacting;
    if (!impacting || column(table, "period")[i] != 1.0) continue;
    numbers_of_impacting.insert(attractor[i]);
    const std::vector<double> velocities = impact_velocities(alpha[i], omega, zeta, r);
    REQUIRE(velocities.size() >= 1);
    // recognised to 1e-6 of the range at a multiplier of 0.86: 1e-5 of a velocity of some units; at the fold, slower
    INFO("alpha = " << alpha[i]);
    CHECK(x2[i] == Approx(velocities.back()).epsilon(alpha[i] > fold + 0.02 ? 1e-4 : 1e-2));
    ++compared;
  }
  CHECK(compared > 80);
  CHECK(numbers_of_impacting.size() == 1);
  for (int k = 0; k <= 80; ++k) {
    const double value = k == 80 ? 2.7 : 1.9 + (2.7 - 1.9) * (k / 80.0);
    INFO("alpha = " << value);
    CHECK(is_impacting[{1.0, value}] == (value > grazing));  // up, from rest
    CHECK(is_impacting[{2.0, value}] == (value > fold));     // down
  }
}

TEST_CASE("sweep: the attractor that coexists with the grazing one down to its fold") {
  const Workspace workspace(Workspace::Plugin::source);
  std::filesystem::copy_file(RAND3D_SOURCE, workspace.file("rand3d.cpp"));
  const double step = 0.006 / 120.0;
  const tchat::SweepTable table =
      sweep(workspace, "rand3d --over mu=-0.802:-0.796:121 PAR(m)=0.28 --follow both --penetration 1", "jump");
  const double fold = -0.7999350433, grazing = -0.798146332928;
  double first_down = 1.0, first_up = 1.0;
  const auto &mu = column(table, "mu"), &start = column(table, "start"), &impacts = column(table, "impacts"),
             &penetration = column(table, "penetration");
  for (std::size_t i = 0; i < table.rows(); ++i) {
    CHECK((impacts[i] > 0.0) == (penetration[i] > 0.0));
    if (impacts[i] == 0.0) {
      // the smooth orbit does not know of the wall: its least x1 stays
      CHECK(penetration[i] == Approx(mu[i] - grazing).margin(1e-6));
      continue;
    }
    double& first = start[i] == 1.0 ? first_up : first_down;
    first = std::min(first, mu[i]);
  }
  CHECK(first_down > fold);
  CHECK(first_down < fold + step);
  CHECK(first_up > grazing);
  CHECK(first_up < grazing + step);
  CHECK(table.attractors.size() == 2);
}

TEST_CASE("sweep: a basin is that of direct integration, and its attractors are orbits") {
  const Workspace workspace(Workspace::Plugin::source);
  const std::string parameters = " PAR(alpha)=2.2 PAR(omega)=1.8901";
  const tchat::SweepTable table = sweep(workspace, "linosc --over x1=-1:1:25 --over x2=-5:5:21" + parameters, "basin");
  REQUIRE(table.attractors.size() == 2);
  const auto &x1 = column(table, "x1(0)"), &x2 = column(table, "x2(0)"), &attractor = column(table, "attractor");
  std::set<double> seen;
  for (std::size_t i = 7; i < table.rows(); i += 37) {
    // 200 events from there: the last ones are impacts, or none is
    const Outcome outcome = workspace.tchat("simulate linosc --state " + fmt::format("x1={},x2={}", x1[i], x2[i]) +
                                            parameters + " --transient-events 200 --events 4 --rows 0 -q -o trial");
    REQUIRE(outcome.status == 0);
    std::istringstream events(workspace.read("trial.events"));
    bool hits = false;
    for (std::string line; std::getline(events, line);) {
      std::istringstream words(line);
      int segment = 0, field = 0, event = 0;
      if (words >> segment >> field >> event) hits = hits || event == 1;
    }
    INFO("x1 = " << x1[i] << ", x2 = " << x2[i]);
    const auto& of = table.attractors[static_cast<std::size_t>(attractor[i]) - 1];
    CHECK(hits == (of.impacts == 1));
    seen.insert(attractor[i]);
  }
  CHECK(seen.size() >= 1);
  for (const tchat::SweepAttractor& of : table.attractors) {
    const std::string state = fmt::format("{}", fmt::join(of.state.begin(), of.state.end(), ","));
    const std::string name = fmt::format("orbit{}", of.number);
    REQUIRE(workspace
                .tchat("simulate linosc -q --state " + state + " --mode " + of.mode + parameters + " --dat " + name +
                       " -o " + name)
                .status == 0);
    const Outcome run = workspace.tchat("run linosc -c " + name + " -d " + name + " -o " + name + " NMX=1");
    INFO(run.text());
    CHECK(run.status == 0);
    const std::vector<SolutionEntry> solutions = workspace.solutions(name);
    REQUIRE(solutions.size() >= 1);
  }
}

TEST_CASE("sweep: captured starts come to where they do when they are simulated to the end") {
  const Workspace workspace(Workspace::Plugin::source);
  const std::string arguments = "linosc --over x1=-1:0.9:30 --over x2=-6:6:30 PAR(alpha)=2.4 PAR(omega)=1.8901";
  const tchat::SweepTable captured = sweep(workspace, arguments, "captured");
  const tchat::SweepTable whole = sweep(workspace, arguments + " --to-the-end", "whole");
  REQUIRE(captured.rows() == whole.rows());
  // numbers may differ in order; what they stand for may not
  for (std::size_t i = 0; i < whole.rows(); ++i) {
    INFO("row " << i);
    CHECK(column(captured, "impacts")[i] == column(whole, "impacts")[i]);
    CHECK(column(captured, "time")[i] == Approx(column(whole, "time")[i]).epsilon(1e-5));
  }
}

TEST_CASE("sweep: problems without optional members, in Fortran with memory, and of formulas, on two workers") {
  const Workspace workspace;
  const char* const cpp = R"(#include <tchat/problem.hpp>
struct Oscillator {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 2, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = par[0] * x[3] - 0.6 * x[1] - x[0];
    f[2] = growth * x[2] + par[1] * x[3];
    f[3] = growth * x[3] - par[1] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T*) const { return j == 1 ? T(1.0 - x[0]) : x[1]; }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -0.8 * x[1];
  }
};
TCHAT_PROBLEM(Oscillator)
)";
  // keeps the sums in SAVE variables between its statements: two threads in one copy of it would mix them up
  const char* const fortran = R"(      SUBROUTINE GCFUNC(N,X,PAR,IDIFF,F,FX,FP,FXX,FXP,I)
      INTEGER N,IDIFF,I
      DOUBLE PRECISION X(N),PAR(*),F(N),GROWTH,FORCE
      DOUBLE PRECISION FX(N,N),FP(N,*),FXX(N,N,N),FXP(N,N,*)
      COMMON /MEMORY/ GROWTH,FORCE
      SAVE /MEMORY/
      GROWTH=1.0D0-X(3)**2-X(4)**2
      FORCE=PAR(1)*X(4)-0.6D0*X(2)
      CALL REST(N,X,PAR,F)
      END
      SUBROUTINE REST(N,X,PAR,F)
      INTEGER N
      DOUBLE PRECISION X(N),PAR(*),F(N),GROWTH,FORCE
      COMMON /MEMORY/ GROWTH,FORCE
      SAVE /MEMORY/
      F(1)=X(2)
      F(2)=FORCE-X(1)
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
      DO L=1,N
        G(L)=X(L)
      END DO
      IF (K.EQ.1) G(2)=-0.8D0*X(2)
      END
)";
  workspace.write("minimal.cpp", cpp);
  workspace.write("old.f", fortran);
  workspace.write("gc.old", "NDIM = 4\nIPS = 180\nGCFIND = [1]\nGCHIND = [2]\nGCGIND = [2]\nICP = [1, 61]\n");
  workspace.write("written.tch", R"(par alpha=1, omega=2
x1' = x2
x2' = alpha*y2 - 0.6*x2 - x1
y1' = (1 - y1^2 - y2^2)*y1 + omega*y2
y2' = (1 - y1^2 - y2^2)*y2 - omega*y1
event wall = 1 - x1
event top = x2
jump impact: x2 -> -0.8*x2
)");
  const std::string over = " --signature 1,2,2 --state 0.1,0,0,1 --over PAR(1)=1:2:60 PAR(2)=2 --section 2";
  // Without impacts: the amplitude of the response is alpha / sqrt((1 - omega^2)^2 + (2 zeta omega)^2), zeta = 0.3.
  const double response = 1.0 / std::sqrt(9.0 + 1.44);
  for (const char* name : {"minimal", "old", "written"}) {
    INFO(name);
    const tchat::SweepTable table = sweep(workspace, name + over + " -j 2", std::string(name) + "2");
    sweep(workspace, name + over, std::string(name) + "1");
    CHECK(workspace.read(std::string(name) + "2.sweep") == workspace.read(std::string(name) + "1.sweep"));
    REQUIRE(table.rows() == 60);
    for (std::size_t i = 0; i < table.rows(); ++i) {
      const double alpha = 1.0 + static_cast<double>(i) / 59.0;
      CHECK(column(table, "impacts")[i] == 0.0);
      CHECK((*table.column(table.names[table.names.size() - 4]))[i] == Approx(alpha * response).epsilon(1e-5));
    }
  }
}

TEST_CASE("sweep: a plugin that dies in a worker's thread is named, and what is computed is kept") {
  const Workspace workspace(Workspace::Plugin::source);
  std::string source = workspace.read("linosc.cpp");
  const std::string line = "    f[0] = x[1];";
  REQUIRE(source.find(line) != std::string::npos);
  source.replace(source.find(line), line.size(), line + " if (par[0] > 2.97) { volatile int* p = nullptr; *p = 1; }");
  workspace.write("dying.cpp", source);
  const Outcome outcome = workspace.tchat("sweep dying --over alpha=2.9:3:40 -j 2");
  CHECK(outcome.status == 2);
  CHECK(contains(outcome.err, "dying.so died in field 1 by signal 11"));
  CHECK_FALSE(workspace.has("dying.sweep"));
  CHECK(contains(workspace.read("dying.sweep.journal"), " periodic "));
}

TEST_CASE("sweep: a library whose copies would share their data has one worker, with a word") {
  const Workspace workspace;
  const Outcome outcome = workspace.tchat("sweep linosc --over alpha=2.9:2.91:3 -j 2");
  CHECK(outcome.status == 0);
  CHECK(contains(outcome.err, "-fno-gnu-unique"));
  CHECK(contains(outcome.err, "one worker computes instead of 2"));
}

TEST_CASE(
    "sweep and simulate: next to a period doubling the orbit that attracts, with one number though a state drifts") {
  // c -> a c (1 - c) once per unit of time: period 1 attracts for a < 3 (multiplier 2 - a), period 2 from there to
  // 1 + sqrt(6). Nothing depends on s.
  const Workspace workspace;
  workspace.write("logistic.tch", R"(par a=2.9
init clock=0, c=0.4, s=0
clock' = 1
c' = 0
s' = c
event tick = 1 - clock
jump iterate: clock -> clock - 1, c -> a*c*(1 - c)
after any: tick -> iterate
)");
  const tchat::SweepTable table = sweep(workspace, "logistic --over a=2.99:3.01:21 --section none --follow up", "near");
  const std::vector<double>&a = column(table, "a"), &period = column(table, "period");
  const std::vector<double>& number = column(table, "attractor");
  REQUIRE(a.size() == 21);
  for (std::size_t k = 0; k < a.size(); ++k) {
    CAPTURE(a[k]);
    if (std::abs(a[k] - 3.0) < 1e-9) continue;  // at the doubling itself
    CHECK(period[k] == (a[k] < 3.0 ? 1 : 2));
    CHECK(number[k] == (a[k] < 3.0 ? number.front() : number.back()));
  }
  const Outcome outcome = workspace.tchat("simulate logistic PAR(a)=2.9999 --lyapunov --rows 0");
  INFO(outcome.text());
  CHECK(outcome.out.find("Periodic orbit, signature {(1,1,1)}, period 1") != std::string::npos);
  CHECK(outcome.out.find("a stable periodic orbit.") != std::string::npos);
  CHECK(outcome.out.find("chaotic") == std::string::npos);
}

TEST_CASE("simulate: a slow mode delays no verdict, and unstable orbits attract nothing") {
  // The unit circle with a mode that decays by exp(-2 pi 1e-6) in each turn, and one that grows as slowly.
  const Workspace workspace;
  workspace.write("slow.tch", R"(par rate=1e-6
init x=1, y=0.1, z=1
x' = x - y - x*(x^2 + y^2)
y' = x + y - y*(x^2 + y^2)
z' = -rate*z
event turn = y
after any: turn -> identity
)");
  const Outcome stable = workspace.tchat("simulate slow --lyapunov --rows 0");
  INFO(stable.text());
  CHECK(stable.out.find("a stable periodic orbit.") != std::string::npos);
  const Outcome growing = workspace.tchat("simulate slow PAR(rate)=-1e-6 --state x=1,y=0.1,z=0 --rows 0");
  INFO(growing.text());
  CHECK(growing.out.find("no attractor") != std::string::npos);
  CHECK(growing.out.find(": stable") == std::string::npos);
}

// Boundary value problems with conditions of their own, against closed forms: Euler's elastica as
// problems/elastica/Makefile runs it, Bratu's problem, a quarter of a pendulum's period on two segments.
#include <fmt/format.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <catch2/catch.hpp>
#include <cmath>

#include "published/makefile_run.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

template <class Function>
double zero(const Function& f, double low, double high) {
  std::uintmax_t most = 200;
  const auto found = boost::math::tools::toms748_solve(f, low, high, boost::math::tools::eps_tolerance<double>(), most);
  return 0.5 * (found.first + found.second);
}

/// A rod of `arcs` arcs with its ends nearer by D: load = (2 arcs K)^2, D = 2 - 2 E / K, the modulus being sin(a / 2)
/// of the angle a at the hinge.
double load(double shortening, int arcs) {
  const auto miss = [&](double k) { return 2 - 2 * boost::math::ellint_2(k) / boost::math::ellint_1(k) - shortening; };
  const double side = 2 * arcs * boost::math::ellint_1(zero(miss, 1e-6, 1.0 - 1e-12));
  return side * side;
}

/// lambda of u'' + lambda exp(u) = 0, u(0) = u(1) = 0 with u(1/2) = 2 ln cosh(theta / 4): lambda = theta^2 / (2
/// cosh^2).
double bratu_lambda(double middle) {
  const double theta = 4.0 * std::acosh(std::exp(0.5 * middle));
  return 0.5 * theta * theta * std::exp(-middle);
}

const char* const bratu_cpp = R"(#include <tchat/problem.hpp>
struct Bratu {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -par[0] * exp(x[0]);
  }
  static constexpr int boundary_conditions = 2;
  template <class T>
  void boundary(const tchat::Ends<T>& u, const T*, T* b) const {
    b[0] = u.start(1)[0];
    b[1] = u.end(1)[0];
  }
};
TCHAT_PROBLEM(Bratu)
)";

/// GCBOUND and JUMPMAP are not needed. GCIDIFF = 1: with derivatives.
const char* const bratu_fortran = R"(      SUBROUTINE GCFUNC(N,X,PAR,IDIFF,F,FX,FP,FXX,FXP,I)
      INTEGER N,IDIFF,I
      DOUBLE PRECISION X(N),PAR(*),F(N),FX(N,N),FP(N,*),FXX(N,N,N),FXP(N,N,*)
      F(1)=X(2)
      F(2)=-PAR(1)*EXP(X(1))
      FX(1,2)=1
      FX(2,1)=-PAR(1)*EXP(X(1))
      FP(2,1)=-EXP(X(1))
      END
      SUBROUTINE GCBCND(N,NSEG,X0,X1,PAR,IDIFF,NBC,FB,FB0,FB1,FBP)
      INTEGER N,NSEG,IDIFF,NBC
      DOUBLE PRECISION X0(N,NSEG),X1(N,NSEG),PAR(*),FB(NBC),FB0(NBC,N,NSEG),FB1(NBC,N,NSEG),FBP(NBC,*)
      FB(1)=X0(1,1)
      FB(2)=X1(1,1)
      FB0(1,1,1)=1
      FB1(2,1,1)=1
      END
)";

const std::string bratu_constants =
    "NDIM = 2, IPS = 4, NBC = 2, ICP = [1]\nNTST = 30, NMX = 60, RL0 = 0, RL1 = 4, DS = 0.05, DSMAX = 0.5\n"
    "EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9, UZR = {1: [1, 3]}, A1 = 100\n";

void check_bratu(const Workspace& workspace, const std::string& plugin, const std::string& more) {
  workspace.write("gc.bratu", bratu_constants);
  workspace.write("bratu.dat", "# PAR(1) = 0.5\n0 0 0\n1 0 0\n");
  const Outcome outcome = workspace.tchat("run bratu -q -p " + plugin + " " + more);
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const auto labels = workspace.solutions("bratu");
  REQUIRE(labels.size() == 7);
  for (const SolutionEntry& u : labels) {
    const double slope = u.states.front()[1];  // u'(0)^2 / 2 + lambda = lambda exp(u(1/2))
    const double lambda = u.parameter(1);
    CHECK(u.problem_type == 4);
    CHECK(u.parameter(61) == 1.0);  // kept, to the bit
    CHECK(u.free_parameters == std::vector<int>{1});
    const double middle = std::log1p(0.5 * slope * slope / lambda);
    // Near lambda = 0 on the upper side u is large, its curvature unresolved by 30 intervals.
    check_near(lambda, bratu_lambda(middle), lambda > 0.5 ? 1e-8 : 1e-6);
  }
  // The fold: theta / 4 = c with c tanh c = 1, lambda = 8 (c^2 - 1).
  const double c = zero([](double z) { return z * std::tanh(z) - 1.0; }, 1.0, 2.0);
  const auto fold = std::find_if(labels.begin(), labels.end(), [](const SolutionEntry& u) { return u.type % 10 == 5; });
  REQUIRE(fold != labels.end());
  check_near(fold->parameter(1), 8.0 * (c * c - 1.0), 1e-8);
}

/// With its independent variable as a third state, which is a polynomial of degree 1 whatever the mesh.
std::string with_time_as_state(const std::string& second_derivative, const std::string& end_condition) {
  return R"(#include <tchat/problem.hpp>
struct Linear {
  static constexpr int dimension = 3, parameters = 1, fields = 1;
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = )" +
         second_derivative + R"(;
    f[2] = T(1.0);
  }
  static constexpr int boundary_conditions = 3;
  template <class T>
  void boundary(const tchat::Ends<T>& u, const T*, T* b) const {
    b[0] = u.start(1)[1];
    b[1] = )" +
         end_condition + R"(;
    b[2] = u.start(1)[2];
  }
};
TCHAT_PROBLEM(Linear)
)";
}

/// The values of PAR(1) at the branch points of the trivial solution, from `low` to `high` with NTST = 40.
std::vector<double> branch_points(const Workspace& workspace, const std::string& length, double low, double high,
                                  int adapt_every) {
  workspace.write("linear.dat",
                  "# PAR(1) = " + std::to_string(low + 1) + "\n0 0 0 0\n" + length + " 0 0 " + length + "\n");
  workspace.write("gc.linear", "NDIM = 3, IPS = 4, NBC = 3, ICP = [1], NTST = 40, NMX = 200, RL0 = " +
                                   std::to_string(low) + ", RL1 = " + std::to_string(high) +
                                   ", EPSL = 1e-10, EPSU = 1e-10, EPSS = 1e-9, DS = 0.1, DSMAX = 2");
  const Outcome outcome = workspace.tchat("run linear -q IAD=" + std::to_string(adapt_every));
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  std::vector<double> values;
  for (const SolutionEntry& u : workspace.solutions("linear"))
    if (u.type % 10 == 6) values.push_back(u.parameter(1));
  return values;
}

}  // namespace

TEST_CASE("make -j2 in problems/elastica: buckling loads and bent rods in closed form") {
  const MakefileRun chain("elastica", "branches");
  for (int arcs = 1; arcs <= 3; ++arcs) {
    const auto n = static_cast<std::size_t>(arcs);
    CAPTURE(arcs);
    check_near(chain.solution("straight", "BP", n).parameter(1), arcs * arcs * pi * pi, 1e-8);
    int bent = 0;
    for (const SolutionEntry& rod : chain.solutions("mode" + std::to_string(arcs))) {
      const double shortening = rod.parameter(2);
      CAPTURE(shortening);
      // Relative to a load of 10 to 300; what 40 intervals resolve of a rod with three arcs that nearly touch.
      check_near(rod.parameter(1) / load(shortening, arcs), 1.0, arcs == 1 ? 1e-9 : 1e-7);
      ++bent;
    }
    CHECK(bent == 3);
  }
  chain.check_verified();

  // The shortening is in the integral condition alone: a label with another one satisfies all but that.
  const double shortening = 0.5;
  const SolutionEntry rod = chain.solution("mode1", "UZ", 1);
  check_near(rod.parameter(2), shortening, 1e-9);
  const std::string before = fmt::format("{:.16E}", rod.parameter(2));  // 5.0...E-01 here, E-001 in the file
  const std::string mantissa = before.substr(0, before.find('E'));
  std::string changed = chain.read("q.mode1");
  const std::size_t at = changed.find(mantissa + "E-001");
  REQUIRE(at != std::string::npos);
  changed[at + 5] = changed[at + 5] == '9' ? '8' : static_cast<char>(changed[at + 5] + 1);
  chain.write("q.changed", changed);
  const auto verify = [&](const std::string& name) {
    return chain.tchat({"verify", name, "-p", chain.plugin(), "-c", "r.mode1"});
  };
  const Outcome right = verify("q.mode1");
  CHECK(right.status == 0);
  CHECK(right.out.find("integral") != std::string::npos);
  const Outcome wrong = verify("q.changed");
  INFO(wrong.text());
  CHECK(wrong.status == 1);
  CHECK(wrong.out.find("<< integral condition\n") != std::string::npos);
}

TEST_CASE("Bratu's problem in closed form: C++ and Fortran, with derivatives by hand and without") {
  const Workspace workspace;
  workspace.write("bratu.cpp", bratu_cpp);
  check_bratu(workspace, "bratu.cpp", "");
  workspace.write("classic.f90", bratu_fortran);
  for (const char* order : {"1", "0"}) check_bratu(workspace, "classic.f90", "GCIDIFF=" + std::string(order));
}

TEST_CASE("an integral is held while the duration is free: C++ and Fortran, with derivatives by hand and without") {
  // x' = -x from 1, and its integral is A: T = -ln(1 - A).
  const Workspace workspace;
  workspace.write("decay.cpp", R"(#include <tchat/problem.hpp>
struct Decay {
  static constexpr int dimension = 1, parameters = 1, fields = 1, boundary_conditions = 1, integral_conditions = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = -x[0];
  }
  template <class T>
  void boundary(const tchat::Ends<T>& x, const T*, T* b) const {
    b[0] = x.start(1)[0] - 1.0;
  }
  template <class T>
  void integrand(int, const T* x, const T* par, const T* durations, T* q) const {
    q[0] = x[0] - par[0] / durations[0];
  }
};
TCHAT_PROBLEM(Decay)
)");
  workspace.write("decay.f90", R"(subroutine gcfunc(n,x,par,idiff,f,fx,fp,fxx,fxp,i)
  integer n,idiff,i
  double precision x(n),par(*),f(n),fx(n,n),fp(n,*),fxx(n,n,n),fxp(n,n,*)
  f(1)=-x(1)
  fx(1,1)=-1
end
subroutine gcbcnd(n,nseg,x0,x1,par,idiff,nbc,fb,fb0,fb1,fbp)
  integer n,nseg,idiff,nbc
  double precision x0(n,nseg),x1(n,nseg),par(*),fb(nbc),fb0(nbc,n,nseg),fb1(nbc,n,nseg),fbp(nbc,*)
  fb(1)=x0(1,1)-1
  fb0(1,1,1)=1
end
subroutine gcicnd(n,x,par,idiff,f,fx,fp,fxx,fxp,i)
  integer n,idiff,i
  double precision x(n),par(*),f(1),fx(1,n),fp(1,*),fxx(1,n,n),fxp(1,n,*)
  f(1)=x(1)-par(1)/par(61)
  fx(1,1)=1
  fp(1,1)=-1/par(61)
  fp(1,61)=par(1)/par(61)**2
end
)");
  workspace.write(
      "gc.decay",
      "NDIM = 1, IPS = 4, NBC = 1, NINT = 1, ICP = [1, 61], NTST = 10, NMX = 100\nEPSL = 1e-11, EPSU = 1e-11, "
      "EPSS = 1e-10, RL0 = 0, RL1 = 0.97, DS = 0.05, DSMAX = 0.2\nUZR = {1: [0.5, 0.75, 0.9]}\n");
  workspace.write("decay.dat", "# PAR(1) = 0.4\n# PAR(61) = 0.51\n0 1\n0.5 0.775\n1 0.6\n");
  for (const std::string problem : {"decay.cpp", "decay.f90 GCIDIFF=1", "decay.f90 GCIDIFF=0"}) {
    CAPTURE(problem);
    const Outcome outcome = workspace.tchat("run decay -q -p " + problem);
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    const auto labels = workspace.solutions("decay");
    REQUIRE(labels.size() == 5);
    for (const SolutionEntry& x : labels) check_near(x.parameter(61), -std::log1p(-x.parameter(1)), 1e-9);
    // A right matrix converges quadratically: two or three iterations a step.
    CHECK(workspace.read("d.decay").find("Iterations   : 6") == std::string::npos);
  }
}

TEST_CASE("a quarter of a pendulum's period on two segments, whose durations are free") {
  const Workspace workspace;
  workspace.write("pendulum.cpp", R"(#include <tchat/problem.hpp>
struct Pendulum {
  static constexpr int dimension = 2, parameters = 1, fields = 1;
  static constexpr const char* parameter_names[] = {"amplitude"};
  static constexpr double initial_parameters[] = {0.5};
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[1];
    f[1] = -sin(x[0]);
  }
  static constexpr int boundary_conditions = 6;
  template <class T>
  void boundary(const tchat::Ends<T>& x, const T* par, T* b) const {
    b[0] = x.start(1)[0] - par[0];
    b[1] = x.start(1)[1];
    b[2] = x.end(1)[0] - 0.5 * par[0];
    b[3] = x.start(2)[0] - x.end(1)[0];
    b[4] = x.start(2)[1] - x.end(1)[1];
    b[5] = x.end(2)[0];
  }
};
TCHAT_PROBLEM(Pendulum)
)");
  workspace.write(
      "gc.pendulum",
      "NDIM = 2, IPS = 4, NBC = 6, ICP = [amplitude, 61, 62], GCFIND = [1, 1]\nNTST = 10, NMX = 100\nEPSL = "
      "1e-10, EPSU = 1e-10, EPSS = 1e-10, RL0 = 0, RL1 = 2.9, DS = 0.05, DSMAX = 0.2\nUZR = {1: [1, 2, "
      "2.5]}\n");
  workspace.write("pendulum.dat",
                  "# PAR(61) = 1.05\n# PAR(62) = 0.52\n0 0.5 0 0.25 -0.43\n0.5 0.43 -0.25 0.13 -0.48\n1 0.25 -0.43 0 "
                  "-0.5\n");
  const Outcome outcome = workspace.tchat("run pendulum -q");
  INFO(outcome.err);
  REQUIRE(outcome.status == 0);
  const auto labels = workspace.solutions("pendulum");
  REQUIRE(labels.size() == 5);
  for (const SolutionEntry& x : labels) {
    const double a = x.parameter(1), k = std::sin(0.5 * a);
    CAPTURE(a);
    const double rest = boost::math::ellint_1(k, std::asin(std::sin(0.25 * a) / k));  // from a / 2 to 0
    check_near(x.parameter(61), boost::math::ellint_1(k) - rest, 1e-8);
    check_near(x.parameter(62), rest, 1e-8);
    CHECK(x.free_parameters == std::vector<int>{1, 61, 62});
  }
  // A restart goes on along the branch: the direction with its durations is stored.
  const Outcome on = workspace.tchat("run pendulum -o on IRS=UZ2 NMX=20 UZR={1:2.5}");
  INFO(on.err);
  REQUIRE(on.status == 0);
  CHECK(on.out.find("on in the direction stored") != std::string::npos);
  // A duration may be the principal parameter, and what ICP lists beyond the free ones is a mere column.
  const Outcome by_time =
      workspace.tchat("run pendulum -q -o time -s pendulum IRS=1 ICP=[61,62,amplitude] UZR={61:1.2}");
  INFO(by_time.err);
  REQUIRE(by_time.status == 0);
  bool found = false;
  for (const SolutionEntry& x : workspace.solutions("time"))
    if (x.type % 10 == -4) check_near(x.parameter(61), 1.2, 1e-9), found = true;
  CHECK(found);
}

TEST_CASE("a heavy rod whose arclength is a state: an adapted mesh is as good as a uniform one") {
  // angle'' = -q s angle, s from the free end, clamped at s = 1: J_{-1/3}(2 sqrt(q) / 3) = 0.
  const Workspace workspace;
  workspace.write("linear.cpp", with_time_as_state("-par[0] * x[2] * sin(x[0])", "u.end(1)[0]"));
  for (const int adapt_every : {0, 1, 3}) {
    CAPTURE(adapt_every);
    const std::vector<double> loads = branch_points(workspace, "1", 0, 100, adapt_every);
    REQUIRE(loads.size() == 2);
    // What q-files keep of a located point; a mesh that follows rounding is 4e-9 to 4e-6 off.
    check_near(loads[0], 7.83734743886, 1e-9);
    check_near(loads[1], 55.9770296813, 1e-9);
  }
}

TEST_CASE("Mathieu's equation with its time as a state: an adapted mesh is as good as a uniform one") {
  // y'' = -(a - 10 cos 2t) y, y' = 0 at 0 and pi: the characteristic values a_0 .. a_4 for q = 5 (Abramowitz and
  // Stegun, table 20.1).
  const Workspace workspace;
  workspace.write("linear.cpp", with_time_as_state("-(par[0] - T(10.0) * cos(T(2.0) * x[2])) * x[0]", "u.end(1)[1]"));
  std::vector<std::vector<double>> values;
  for (const int adapt_every : {0, 1, 3})
    values.push_back(branch_points(workspace, "3.141592653589793", -10, 20, adapt_every));
  const std::vector<double> exact{-5.80004602085, 1.85818754147, 7.44910973950, 11.5488320364, 17.0965816844};
  for (const std::vector<double>& found : values) {
    REQUIRE(found.size() == exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k) {
      CAPTURE(k);
      CHECK(std::abs(found[k] - exact[k]) < 1e-8);  // NTST = 40 resolves a_4 to 5e-9
      CHECK(std::abs(found[k] - values.front()[k]) < 1e-9);
    }
  }
}

// Boundary value problems: what is refused, and what other commands make of them.
#include <catch2/catch.hpp>

#include "end_to_end/bad_input.hpp"
#include "end_to_end/workspace.hpp"

using namespace test_support;

namespace {

const char* const source = R"(#include <tchat/problem.hpp>
struct Rod {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  static constexpr const char* parameter_names[] = {"load", "shortening"};
  static constexpr double initial_parameters[] = {5, 0};
  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -par[0] * sin(x[0]);
  }
  static constexpr int boundary_conditions = 2, integral_conditions = 1;
  template <class T>
  void boundary(const tchat::Ends<T>& rod, const T*, T* b) const {
    b[0] = rod.start(1)[1];
    b[1] = rod.end(SEGMENT)[1];
  }
  template <class T>
  void integrand(int, const T* x, const T* par, T* q) const {
    q[0] = T(1.0) - par[1] - cos(x[0]);
  }
};
TCHAT_PROBLEM(Rod)
)";

void write_rod(const Workspace& workspace, const std::string& segment = "1") {
  std::string text = source;
  text.replace(text.find("SEGMENT"), 7, segment);
  workspace.write("rod.cpp", text);
  workspace.write("gc.rod",
                  "NDIM = 2, IPS = 4, NBC = 2, NINT = 1, ICP = [load, shortening]\nNTST = 10, NMX = 10, RL1 = "
                  "120, DS = 0.1, DSMAX = 5\n");
  workspace.write("rod.dat", "0 0 0\n1 0 0\n");
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

}  // namespace

TEST_CASE("the count of conditions and free parameters is checked and named") {
  const Workspace workspace;
  write_rod(workspace);
  check_refused(workspace, "run rod NBC=0", {"NBC", "IPS = 4"});
  check_refused(workspace, "run rod NBC=3", {"ICP", "3 + 1 - 2 1 + 1 = 3"});
  check_refused(workspace, "run rod NBC=1", {"NBC is 1", "2 boundary conditions", "NBC = 2"});
  check_refused(workspace, "run rod NINT=0", {"NINT is 0", "NINT = 1"});
  check_refused(workspace, "run rod NBC=1 NINT=0", {"NBC", "no parameter free", "1 + 0 - 2 1 + 1 = 0"});
  check_refused(workspace, "run rod ICP=[load]", {"ICP", "1 parameters", "2 + 1 - 2 1 + 1 = 2"});
  check_refused(workspace, "run rod GCHIND=[1]", {"GCHIND(1)", "'1'", "boundary conditions tie"});
  check_refused(workspace, "run rod GCHGRZIND=[[1]] GCIPSI=[1]", {"GCHGRZIND"});
  check_refused(workspace, "run rod IPS=180", {"All states of the start are equal", "GCHIND = [0]", "IPS = 1"});
  check_refused(workspace, "run rod ISW=2", {"IPS = 4 with ISW = 2"});
  check_refused(workspace,
                "run linosc -c impacting -d impacting IPS=4 NBC=5 GCHIND=[0] GCGIND=[0] GCHGRZIND=[[]] GCIPSI=[]",
                {"needs boundary conditions", "boundary", "GCBCND"});
}

TEST_CASE("a condition on a segment that is not there is told, and so is a Fortran condition left unset") {
  const Workspace workspace;
  write_rod(workspace, "2");
  check_refused(workspace, "run rod", {"boundary condition 1 is not finite", "1 segment"});
  check_refused(workspace, "check rod", {});
  workspace.write("unset.f90", R"(subroutine gcfunc(n,x,par,idiff,f,fx,fp,fxx,fxp,i)
  integer n,idiff,i
  double precision x(n),par(*),f(n),fx(n,n),fp(n,*),fxx(n,n,n),fxp(n,n,*)
  f(1)=x(2)
  f(2)=-par(1)*sin(x(1))
end
subroutine gcbcnd(n,nseg,x0,x1,par,idiff,nbc,fb,fb0,fb1,fbp)
  integer n,nseg,idiff,nbc
  double precision x0(n,nseg),x1(n,nseg),par(*),fb(nbc),fb0(nbc,n,nseg),fb1(nbc,n,nseg),fbp(nbc,*)
  fb(1)=x0(1,1)
end
)");
  const std::string run = "run rod -p unset.f90 GCIDIFF=0 ICP=[1] ";
  check_refused(workspace, run + "NINT=0", {"GCBCND leaves FB(2) unset", "NBC = 2"});
  check_refused(workspace, run + "NINT=0 NBC=3 ICP=[1,61]", {"GCBCND leaves FB(2) unset"});
  check_refused(workspace, run + "ICP=[1,2]", {"GCICND is missing"});
}

TEST_CASE("other commands on a boundary value problem") {
  const Workspace workspace;
  write_rod(workspace);
  REQUIRE(workspace.tchat("run rod -q").status == 0);
  CHECK(workspace.tchat("verify q.rod").status == 0);
  const Outcome checked = workspace.tchat("check rod");
  CHECK(checked.status == 0);
  CHECK(checked.out.find("boundary conditions 1 to 2") != std::string::npos);
  CHECK(checked.out.find("integrand") != std::string::npos);
  check_refused(workspace, "resegment q.rod 1 --to double -o twice", {"boundary value problem", "no signature"});
  check_refused(workspace, "simulate rod --time 1 --state 0.1,0", {"no event functions"});
}

// Two period doublings close together, a narrow band in which the orbit is unstable: both have labels when steps are
// far longer than the band. The return map is x -> m(p) x with m = -1 - width^2 + (p - 1)^2, so that they are at 1 -+
// width.
#include <catch2/catch.hpp>
#include <cmath>

#include "published/chain.hpp"

using namespace test_support;

namespace {

const char* const source = R"(#include <tchat/problem.hpp>
struct Band {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 1, jumps = 1;
  static constexpr const char* parameter_names[] = {"p", "width"};
  template <class T>
  void field(int, const T*, const T*, T* f) const {
    f[0] = 0.0;
    f[1] = 1.0;
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[1];
  }
  template <class T>
  void jump(int, const T* x, const T* par, T* g) const {
    const T m = -1.0 - par[1] * par[1] + (par[0] - 1.0) * (par[0] - 1.0);
    g[0] = m * x[0];
    g[1] = 0.0;
  }
};
TCHAT_PROBLEM(Band)
)";

}  // namespace

TEST_CASE("two period doublings between two points of a branch have their labels") {
  const Workspace workspace;
  workspace.write("band.cpp", source);
  workspace.write(
      "gc.band",
      "NDIM = 2, ICP = [p, 61], NTST = 5, NMX = 60, RL0 = -1, RL1 = 3, DS = 0.1, DSMAX = 0.5\nGCFIND = [1], "
      "GCHIND = [1], GCGIND = [1]\n");
  for (const double start : {-0.3, -0.11, 0.02, 0.17}) {
    CAPTURE(start);
    const double width = 0.03;
    workspace.write("band.dat", "# PAR(1) = " + std::to_string(start) + "\n# PAR(2) = " + std::to_string(width) +
                                    "\n# PAR(61) = 1\n0 0 0\n1 0 1\n");
    const Outcome outcome = workspace.tchat("run band -q");
    INFO(outcome.err);
    REQUIRE(outcome.status == 0);
    std::vector<double> found;
    for (const SolutionEntry& orbit : workspace.solutions("band"))
      if (orbit.type == 7) found.push_back(orbit.parameter(1));
    REQUIRE(found.size() == 2);
    CHECK(found[0] == Approx(1.0 - width).margin(1e-7));
    CHECK(found[1] == Approx(1.0 + width).margin(1e-7));
  }
}

// Chua's circuit with its piecewise linear diode, one scroll: x' = alpha (y - x - f(x)), y' = x - y + z, z' = -beta y.
//
// In the outer region x > 1 the equilibrium has a pair of eigenvalues on the imaginary axis at
//
//     beta + alpha (c - 1) + alpha^2 c (c - 1) = 0,   c = 1 + b,
//
// for beta = 100/7, b = -5/7 at alpha = (sqrt(1169) - 7) / 4: the cycle that crosses x = 1 ends there in one that
// touches it, of a whole family in the plane of the centre (Freire, Ponce, Ros). The field is continuous, so the map of
// a period is a product of two matrix exponentials.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "end_to_end/workspace.hpp"
#include "published/makefile_run.hpp"
#include "published/newton.hpp"
#include "support/random_matrices.hpp"

using namespace test_support;

namespace {

const std::string circuit = R"(
par alpha=8, beta=100/7, a=-8/7, b=-5/7
init x=1.5, y=0.1, z=-1.5
y' = x - y + z
z' = -beta*y
field inner
x' = alpha*(y - x - a*x)
field outer
x' = alpha*(y - x - b*x - (a-b))
event into_inner = x - 1
event into_outer = 1 - x
event centre = y
after into_inner: inner until into_outer -> identity
after any: outer until into_inner -> identity
)";

constexpr double beta = 100.0 / 7.0, inner = -8.0 / 7.0, outer = -5.0 / 7.0;

Eigen::Matrix3d jacobian(double slope, double alpha) {
  Eigen::Matrix3d j;
  j << -alpha * (1.0 + slope), alpha, 0.0, 1.0, -1.0, 1.0, 0.0, -beta, 0.0;
  return j;
}

Eigen::Matrix3d exponential(const Eigen::Matrix3d& matrix) { return tchat::test::exponential(matrix); }

/// (x, y, z) after the time t, in the region with its slope and equilibrium at x = rest, z = -rest.
Eigen::Vector3d after(const Eigen::Vector3d& start, double slope, double rest, double t, double alpha) {
  const Eigen::Vector3d equilibrium(rest, 0.0, -rest);
  return equilibrium + exponential(jacobian(slope, alpha) * t) * (start - equilibrium);
}

}  // namespace

TEST_CASE("Chua's circuit: the cycle ends in closed form where its contact is lost, and doubles as linear pieces do") {
  const Workspace workspace;
  workspace.write("chua.tch", circuit);
  REQUIRE(workspace.tchat("simulate chua --dat start").status == 0);
  const Outcome down = workspace.tchat("run chua -c start -d start -o down DS=-0.02 DSMAX=0.1 NMX=100");
  INFO(down.text());
  REQUIRE(down.status == 0);
  const SolutionEntry lost = only(workspace, "down", "GR");
  check_near(lost.parameter(1), (std::sqrt(1169.0) - 7.0) / 4.0);
  // The period of the centre: its eigenvalues are +- i sqrt(beta + alpha c - alpha).
  const double alpha = lost.parameter(1), w = std::sqrt(beta + alpha * outer);
  check_near(lost.parameter(61) + lost.parameter(62), 2.0 * std::acos(-1.0) / w, 1e-8);

  // Joined, in the section y = 0, it is one orbit of the linear flow.
  const Outcome joined = workspace.tchat("resegment q.down GR1 --to signature --signature 2,3,1 -o joined -p chua");
  INFO(joined.text());
  REQUIRE(joined.status == 0);
  const SolutionEntry whole = workspace.solutions("joined").front();
  const std::vector<double>& at = whole.states.front();  // y, z, x: in the order of the file
  check_near(at[0], 0.0, 1e-7);
  const Eigen::Vector3d start(at[2], at[0], at[1]);
  const Eigen::Vector3d later = after(start, outer, 1.5, 0.37 * whole.parameter(61), alpha);
  const double time = 0.37;
  std::size_t k = 0;
  while (whole.t[k + 1] < time) ++k;
  const double share = (time - whole.t[k]) / (whole.t[k + 1] - whole.t[k]);
  CHECK(std::abs((1.0 - share) * whole.states[k][2] + share * whole.states[k + 1][2] - later(0)) < 2e-4);
  CHECK(std::abs(whole.states[k][2] - after(start, outer, 1.5, whole.t[k] * whole.parameter(61), alpha)(0)) < 1e-7);

  // Upwards it doubles. Unknown: y, z where it enters x < 1, the two durations, alpha.
  REQUIRE(workspace.tchat("run chua -c start -d start -o up DS=0.02 DSMAX=0.1 NMX=20").status == 0);
  const SolutionEntry doubling = only(workspace, "up", "PD");
  const auto rounded = [](double value) { return std::round(value * 1e3) / 1e3; };
  Eigen::VectorXd near(5);
  near << rounded(doubling.states.front()[0]), rounded(doubling.states.front()[1]), rounded(doubling.parameter(61)),
      rounded(doubling.parameter(62)), rounded(doubling.parameter(1));
  const Eigen::VectorXd exact = newton(near, 1e-9, [&](const Eigen::VectorXd& z) {
    const Eigen::Vector3d begin(1.0, z(0), z(1));
    const Eigen::Vector3d middle = after(begin, inner, 0.0, z(2), z(4));
    const Eigen::Vector3d end = after(middle, outer, 1.5, z(3), z(4));
    const Eigen::Matrix3d map = exponential(jacobian(outer, z(4)) * z(3)) * exponential(jacobian(inner, z(4)) * z(2));
    Eigen::VectorXd defect(5);
    defect << middle(0) - 1.0, end - begin, (map + Eigen::Matrix3d::Identity()).determinant();
    return defect;
  });
  check_near(doubling.parameter(1), exact(4));
}

// Duffing's oscillator as problems/duffing/Makefile runs it: a closed branch, and the loss of symmetry in two
// parameters against shooting over half a period.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "motion/orbit_flow.hpp"
#include "published/makefile_run.hpp"
#include "published/newton.hpp"
#include "support/test_system.hpp"

#pragma push_macro("TCHAT_PROBLEM")
#undef TCHAT_PROBLEM
#define TCHAT_PROBLEM(PROBLEM) static_assert(PROBLEM::dimension == 4);
#include "../../problems/duffing/duffing.cpp"
#pragma pop_macro("TCHAT_PROBLEM")

using namespace test_support;

namespace {

/// z = (x, v, omega, d) where the section is crossed: zero where half a period later the orbit is turned round, and
/// det(Phi' - Id) = 0 of the flow of (x, v) over half a period.
Eigen::Vector3d defect(const Eigen::VectorXd& z) {
  Eigen::VectorXd start(4);
  start << z(0), z(1), 0.0, -1.0;
  const tchat::SegmentFlow flow =
      tchat::integrate_for(tchat::test::system_of<Duffing>(), 1, start, Eigen::Vector3d(z(2), z(3), 3.0), M_PI / z(2));
  REQUIRE(flow.status == tchat::FlowStatus::time_reached);
  const Eigen::Matrix2d by_start = flow.jacobian.topLeftCorner<2, 2>();
  Eigen::Vector3d result;
  result << flow.end_state.head<2>() + z.head<2>(), (by_start - Eigen::Matrix2d::Identity()).determinant();
  return result;
}

/// Of a solution from the exact curve, an oval in (omega, d), along the ray from its middle.
double distance_from_curve(const SolutionEntry& solution) {
  const auto& state = solution.states.front();
  Eigen::Vector4d start(state[0], state[1], solution.parameter(1), solution.parameter(2));
  const Eigen::Vector2d ray = (start.tail<2>() - Eigen::Vector2d(0.965, 0.0)).normalized();
  const Eigen::Vector2d across(-ray(1), ray(0));
  const Eigen::VectorXd exact = newton(start, 1e-11, [&](const Eigen::VectorXd& z) -> Eigen::VectorXd {
    Eigen::Vector4d all;
    all << defect(z), across.dot(z.tail<2>() - start.tail<2>());
    return all;
  });
  return (exact - start).norm();
}

}  // namespace

TEST_CASE("make -j2 in problems/duffing: a closed branch, and symmetry breaking against shooting") {
  const MakefileRun chain("duffing", "branches");
  chain.check_repeatable();
  chain.check_verified();

  // Once round: BP at either end, back at the first point, its mirror image on the way.
  const auto sections = chain.points("asymmetric");
  REQUIRE(sections.size() == 1);
  const std::vector<PointRow>& rows = sections.front().rows;
  const std::size_t amplitude = sections.front().column("MAX x");
  CHECK(rows.back().values[0] == Approx(rows.front().values[0]).epsilon(1e-9));
  CHECK(rows.back().values[amplitude] == Approx(rows.front().values[amplitude]).epsilon(1e-9));
  CHECK(rows.back().type == 9);
  std::vector<double> ends;
  for (const PointRow& row : rows)
    if (row.type == 6) ends.push_back(row.values[0]);
  REQUIRE(ends.size() == 2);
  check_near(ends[0], chain.solution("resonance", "BP", 2).parameter(1), 1e-7);
  check_near(ends[1], chain.solution("resonance", "BP", 1).parameter(1), 1e-7);

  // At d = 0 areas are kept, so that the multiplier 1 is a double one.
  for (const std::size_t n : {1u, 2u}) check_near(chain.solution("symmetry_breaking", "R1", n).parameter(2), 0.0);

  chain.run("-c r.symmetry_breaking -s resonance -o labelled NPR=3");
  int seen = 0;
  for (const SolutionEntry& solution : chain.solutions("labelled")) {
    INFO("omega = " << solution.parameter(1) << ", d = " << solution.parameter(2));
    CHECK(distance_from_curve(solution) < 1e-9);
    ++seen;
  }
  CHECK(seen >= 15);
}

// Second and third derivatives of an orbit's equations along one direction, against differences of the equations.
#include <array>
#include <catch2/catch.hpp>
#include <random>

#include "orbit/condensed_system.hpp"
#include "orbit/orbit_expansion.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "support/sampled_orbit.hpp"
#include "support/three_modes.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// All rows of the equations: of collocation, events and jumps with their sign.
Eigen::VectorXd equations(const PeriodicOrbitSystem& system, CondensedSystem& condensed, const Orbit& x) {
  OrbitResidual residual = condensed.make_residual();
  condensed.evaluate(x, residual);
  Eigen::VectorXd rows(static_cast<Eigen::Index>(residual.collocation.size() + residual.coupling.size()));
  rows << Eigen::VectorXd::Map(residual.collocation.data(), static_cast<Eigen::Index>(residual.collocation.size())),
      Eigen::VectorXd::Map(residual.coupling.data(), static_cast<Eigen::Index>(residual.coupling.size()));
  REQUIRE(system.coupling_rows(0) == 1 + system.dimension());
  return rows;
}

Eigen::VectorXd joined(const RowWeights& rows) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(rows.collocation.size() + rows.ends.size()));
  all << Eigen::VectorXd::Map(rows.collocation.data(), static_cast<Eigen::Index>(rows.collocation.size())),
      Eigen::VectorXd::Map(rows.ends.data(), static_cast<Eigen::Index>(rows.ends.size()));
  return all;
}

}  // namespace

TEST_CASE("second and third derivatives of the equations along a direction are limits of differences") {
  const HybridSystem& hybrid = system_of<ThreeModes>();
  const PeriodicOrbit reference = ThreeModes::orbit(ThreeModes::par());
  const Orbit x = sampled_orbit(pieces_of(hybrid, ThreeModes::signature(), reference.map, ThreeModes::par()), 3, 6, 4,
                                ThreeModes::par());
  const PeriodicOrbitSystem system(hybrid, ThreeModes::signature(), {1});
  CondensedSystem condensed(system, x.shape, {1});
  OrbitVector u(x.shape, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  u.set_zero();
  for (double& entry : u.states.reshaped()) entry = uniform(random);
  for (double& entry : u.durations) entry = uniform(random);

  DirectionalExpansion expansion(system, x.shape);
  RowWeights second = expansion.make_rows(), third = expansion.make_rows();
  expansion.find(x, u, second, third);

  constexpr double step = 0.01;
  std::array<Eigen::VectorXd, 7> at;
  for (int k = -3; k <= 3; ++k) {
    Orbit moved = x;
    advance(moved, k * step, u, system.free_parameters());
    at[static_cast<std::size_t>(k + 3)] = equations(system, condensed, moved);
  }
  const Eigen::VectorXd by_second =
      (-at[1] + 16.0 * at[2] - 30.0 * at[3] + 16.0 * at[4] - at[5]) / (12.0 * step * step);
  const Eigen::VectorXd by_third =
      (at[0] - 8.0 * at[1] + 13.0 * at[2] - 13.0 * at[4] + 8.0 * at[5] - at[6]) / (8.0 * step * step * step);
  REQUIRE(by_second.size() == joined(second).size());
  CHECK(by_second.norm() > 1e-2);
  CHECK(by_third.norm() > 1e-2);
  CHECK((joined(second) - by_second).norm() < 1e-6 * by_second.norm());
  CHECK((joined(third) - by_third).norm() < 1e-5 * by_third.norm());
}

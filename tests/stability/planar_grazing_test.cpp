// Grazing in the plane: the limit cycle rho = 1 of rho' = rho (1 - rho^2), theta' = 1, and a wall x = w that returns
// the velocity y times -r. Between impacts rho(t)^2 = 1 / (1 + (1 / rho(0)^2 - 1) exp(-2 t)). The multiplier stays
// finite where the impact velocity goes through zero, at w = 1, and w is largest there: dw/dv = 0.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double r = 0.5;

struct PlanarImpacts {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* u, const T*, T* f) const {
    const T growth = 1.0 - u[0] * u[0] - u[1] * u[1];
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
  }
  template <class T>
  T event(int, const T* u, const T* p) const {
    return p[0] - u[0];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    g[0] = u[0], g[1] = -r * u[1];
  }
};

Tests tests_of(const DefiningSystem& system, bool fold_first) {
  Tests tests;
  tests.push_back(std::make_unique<ImpactVelocityTest>(system, 0, false));
  tests.insert(fold_first ? tests.begin() : tests.end(),
               std::make_unique<FoldTest>(1, system.free_parameters(), ParameterLayout(), 1, false));
  tests.push_back(std::make_unique<PeriodDoublingTest>(false));
  return tests;
}

/// The orbit that hits the wall x = w from below, by fixed-point iteration on its impact velocity.
Orbit impacting(double w) {
  double velocity = 0.3;
  double period = 0.0;
  double angle = 0.0;
  double radius = 1.0;
  const auto radius_at = [&](double t) {
    return 1.0 / std::sqrt(1.0 + (1.0 / (radius * radius) - 1.0) * std::exp(-2.0 * t));
  };
  for (int iteration = 0; iteration < 100; ++iteration) {
    radius = std::hypot(w, r * velocity);
    angle = std::atan2(r * velocity, w);
    for (int k = 0; k < 20; ++k) period = 2 * pi - angle - std::acos(w / radius_at(k == 0 ? 2 * pi : period));
    velocity = radius_at(period) * std::sin(std::acos(w / radius_at(period)));
  }
  const auto state = [=](double t) {
    return Eigen::VectorXd(radius_at(t) * Eigen::Vector2d(std::cos(angle + t), std::sin(angle + t)));
  };
  return sampled_orbit({{period, state}}, 2, 20, 4, parameters({w}));
}

}  // namespace

// The branch turns at grazing because w is even in v, not because orbits meet: their multiplier is r^2 exp(-4 pi)
// there, far from 1. So it is no LP. The function of the period doubling vanishes with h_x f, and no multiplier is -1.
TEST_CASE("planar grazing: neither fold nor period doubling where only the impact velocity vanishes") {
  for (const bool fold_first : {false, true})
    for (const double ds_max : {0.03, 0.1, 0.3}) {
      CAPTURE(fold_first, ds_max);
      const Orbit start = impacting(0.95);
      PeriodicOrbits orbits(system_of<PlanarImpacts>(), {{1, 1, 1}}, 1, start.shape);
      const PathPoint point = orbits.corrected(start);
      REQUIRE(orbits.result.converged());
      ContinuationSettings settings = branch_settings(start.shape, 1, 0.02, ds_max, 40);
      settings.location_tolerance = 1e-9;
      settings.parameter_min = 0.6;
      const RecordedBranch branch =
          record(orbits.follower, orbits.system, point, settings, tests_of(orbits.system, fold_first));
      std::string found;
      for (const RecordedPoint* p : branch.special())
        found += fmt::format("{} at w = {:.12g}: {}\n", p->number, p->orbit.par(0), p->special.description);
      CAPTURE(found);
      // All three functions change sign, once.
      for (std::size_t test = 0; test < 3; ++test) {
        CAPTURE(test);
        int changes = 0;
        double before = *branch.points.front().values[test];
        for (const RecordedPoint& p : branch.points) {
          REQUIRE(p.values[test]);
          const double value = *p.values[test];
          if (value * before < 0.0) ++changes;
          if (value != 0.0 && p.special.type == PointType::ordinary) before = value;
        }
        CHECK(changes == 1);
      }
      REQUIRE(branch.special().size() == 1);
      const RecordedPoint& grazing = *branch.special()[0];
      CHECK(grazing.special.type == PointType::user);
      CHECK(grazing.special.kind.kind == UserPointKind::impact_velocity);
      CHECK(grazing.special.further.empty());
      CHECK(grazing.orbit.par(0) == Approx(1.0).epsilon(1e-9));
      CHECK(grazing.multipliers.undetermined == 1);
      CHECK(branch.notes.empty());
      CHECK(branch.summary.lost.empty());
      // The branch has gone through.
      CHECK(branch.points.back().orbit.par(0) < 0.99);
    }
}

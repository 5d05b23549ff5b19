// A branch that comes back to its first point ends there, and only such a one. Circular orbits of radius r at height z,
// so that branches are plane or space curves of our choice.
#include <catch2/catch.hpp>
#include <cmath>

#include "continuation/branch_limits.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/recorded_branch.hpp"
#include "stability/test_function.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

constexpr double waist = 0.02;  // of the ovals

/// PAR(1) = p. Field 1, an isola: (r - 2)^2 + p^2 = 1/4, z = 0. Field 2: p^2 + z^2 = 1, r = 2 + p z, a space curve
/// whose projection on (p, r) is a figure of eight. Field 3, an oval with a waist, of Cassini's: with u = r - 2 (u^2 +
/// p^2)^2 - 2 (p^2 - u^2) = waist, z = 0; at p = 0 its two sides are 2 |u| = 0.2 apart and run opposite ways.
struct ClosedCurves {
  static constexpr int dimension = 3, parameters = 1, fields = 3, events = 1, jumps = 1;
  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T r = sqrt(x[0] * x[0] + x[1] * x[1]);
    const T p = par[0], z = x[2], u = r - 2.0;
    T growth = u * u + p * p - 0.25;
    if (i == 2) growth = 2.0 + p * z - r;
    if (i == 3) growth = (u * u + p * p) * (u * u + p * p) - 2.0 * (p * p - u * u) - waist;
    f[0] = x[0] * growth - x[1];
    f[1] = x[1] * growth + x[0];
    f[2] = i == 2 ? T(p * p + z * z - 1.0) : T(-z);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int k = 0; k < 3; ++k) g[k] = x[k];
  }
};

struct Variant {
  int field = 1;
  double p = 0.0, r = 2.5, z = 0.0;  ///< the start
  double step = 0.05;
  int adapt_every = 3;
  int points = 2000;
  bool stop = true;
  std::vector<double> user_values = {};
};

double radius(const Orbit& x) { return std::hypot(x.states(0, 0), x.states(1, 0)); }

RecordedBranch go_round(const Variant& v) {
  const auto state = [&v](double t) {
    return Eigen::VectorXd(Eigen::Vector3d(v.r * std::cos(pi + t), v.r * std::sin(pi + t), v.z));
  };
  const Orbit start = sampled_orbit({{2 * pi, state}}, 3, 20, 5, parameters({v.p}));
  PeriodicOrbits orbits(system_of<ClosedCurves>(), {{v.field, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, v.step, std::abs(v.step), v.points);
  settings.location_tolerance = 1e-9;
  settings.adapt_mesh_every = v.adapt_every;
  settings.stop_when_closed = v.stop;
  Tests tests;
  tests.push_back(std::make_unique<FoldTest>(1, orbits.system.free_parameters(), ParameterLayout(), 1, false));
  for (const double value : v.user_values) tests.push_back(std::make_unique<UserValueTest>(1, value, false, "p"));
  return record(orbits.follower, orbits.system, point, settings, std::move(tests));
}

/// Ended as closed at its first point, with so many folds and user values, each found once.
void check_closed(const RecordedBranch& branch, std::size_t folds, std::size_t user_values = 0) {
  CHECK(branch.summary.reason == EndReason::closed);
  CHECK(branch.of_type(PointType::fold).size() == folds);
  CHECK(branch.of_type(PointType::user).size() == user_values);
  const Orbit& first = branch.points.front().orbit;
  const Orbit& last = branch.points.back().orbit;
  CHECK(std::abs(first.par(0) - last.par(0)) < 1e-9);
  CHECK(std::abs(first.duration(0) - last.duration(0)) < 1e-9);
  CHECK((first.states - last.states).cwiseAbs().maxCoeff() < 1e-9);
}

/// From the start at each angle of the circle, in radians.
void go_round_isola(double step, int adapt_every, std::initializer_list<double> angles) {
  for (const double angle : angles) {
    INFO("DS = " << step << ", IAD = " << adapt_every << ", start at angle " << angle);
    Variant v;
    v.step = step;
    v.adapt_every = adapt_every;
    v.p = 0.5 * std::sin(angle);
    v.r = 2.0 + 0.5 * std::cos(angle);
    const RecordedBranch branch = go_round(v);
    check_closed(branch, 2);
    CHECK(branch.points.back().special.type == PointType::end);
    for (const RecordedPoint& point : branch.points)
      CHECK(std::hypot(radius(point.orbit) - 2.0, point.orbit.par(0)) == Approx(0.5).epsilon(1e-9));
    for (const RecordedPoint* fold : branch.of_type(PointType::fold))
      CHECK(std::abs(fold->orbit.par(0)) == Approx(0.5).epsilon(1e-9));
  }
}

}  // namespace

TEST_CASE("an isola is gone round once, whatever the long step, the meshes and the place of the start") {
  for (const double step : {0.9, -0.9})
    for (const int adapt_every : {0, 1, 3}) go_round_isola(step, adapt_every, {0.0, 0.4, 1.5, 3.0});
}

TEST_CASE("an isola is gone round once, whatever the short step, the meshes and the place of the start", "[slow]") {
  for (const double step : {0.01, 0.05, 0.2, -0.05})
    for (const int adapt_every : {0, 1, 3}) go_round_isola(step, adapt_every, {0.0, 0.4, 1.5, 3.0});
}

TEST_CASE("special points between the last step and the first point are found, each once") {
  // One just before the first point, one just behind it, one at the first point itself.
  for (const double value : {-1e-3, -1e-6, 0.0, 1e-6, 1e-3}) {
    INFO("user value " << value);
    Variant v;
    v.user_values = {value};
    const RecordedBranch branch = go_round(v);
    check_closed(branch, 2, 2);  // on either side of the isola
    // At the first point, which has no label of the kind, the last point is the user value.
    CHECK((branch.points.back().special.type == PointType::user) == (value == 0.0));
  }
}

TEST_CASE("a branch that starts at a fold finds it once") {
  const auto state = [](double t) {
    return Eigen::VectorXd(Eigen::Vector3d(2.0 * std::cos(pi + t), 2.0 * std::sin(pi + t), 0.0));
  };
  const Orbit start = sampled_orbit({{2 * pi, state}}, 3, 20, 5, parameters({0.5}));
  PeriodicOrbits orbits(system_of<ClosedCurves>(), {{1, 1, 1}}, 1, start.shape);
  PathPoint point = orbits.follower.make_point(start);
  REQUIRE(orbits.follower.start_by_minimum_norm(point).converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, 0.05, 0.1, 500);
  settings.location_tolerance = 1e-9;
  Tests tests;
  tests.push_back(std::make_unique<FoldTest>(1, orbits.system.free_parameters(), ParameterLayout(), 1, false));
  const RecordedBranch branch = record(orbits.follower, orbits.system, point, settings, std::move(tests));
  check_closed(branch, 2);
}

TEST_CASE("a branch that crosses itself in parameter and radius goes on until it is really back") {
  Variant v;
  v.field = 2;
  v.r = 2.0;
  v.z = 1.0;
  for (const double step : {0.05, -0.05, 0.3}) {
    v.step = step;
    const RecordedBranch branch = go_round(v);
    check_closed(branch, 2);
    double lowest = 1.0;
    for (const RecordedPoint& point : branch.points) lowest = std::min(lowest, point.orbit.states(2, 0));
    CHECK(lowest < -0.95);  // the other point with p = 0 and r = 2 has z = -1
  }
}

TEST_CASE("a branch that passes near its first point in the other direction is not closed there") {
  Variant v;
  v.field = 3;
  v.r = 2.0 + std::sqrt(std::sqrt(1.0 + waist) - 1.0);
  for (const double step : {0.02, -0.02, 0.05}) {
    v.step = step;
    const RecordedBranch branch = go_round(v);
    CHECK(branch.summary.reason == EndReason::closed);
    double least = 0.0, most = 0.0;
    for (const RecordedPoint& point : branch.points) {
      least = std::min(least, point.orbit.par(0));
      most = std::max(most, point.orbit.par(0));
    }
    CHECK(least < -1.3);
    CHECK(most > 1.3);
  }
}

TEST_CASE("CLSTOP = 0: the branch goes on round again") {
  Variant v;
  v.stop = false;
  v.points = 150;
  const RecordedBranch branch = go_round(v);
  CHECK(branch.summary.reason == EndReason::max_points);
  CHECK(branch.of_type(PointType::fold).size() > 3);
}

TEST_CASE("orbits of no fixed phase are compared by what does not depend on it") {
  const auto state = [](double t) {
    return Eigen::VectorXd(Eigen::Vector3d(2.5 * std::cos(pi + t), 2.5 * std::sin(pi + t), 0.0));
  };
  const Orbit start = sampled_orbit({{2 * pi, state}}, 3, 20, 5, parameters({0.0}));
  PeriodicOrbits orbits(system_of<ClosedCurves>(), {{1, 1, 1}}, 1, start.shape);
  for (const double ds : {0.05, 0.13, -0.3}) {
    PathPoint here = orbits.corrected(start);
    REQUIRE(orbits.result.converged());
    ClosedBranch closed(orbits.follower, orbits.system, false);
    closed.begin(here, ds);
    PathPoint next = here;
    std::optional<ClosedBranch::Return> back;
    double length = 0.0;
    while (!back && std::abs(length) < 6.0 * pi) {
      REQUIRE(orbits.follower.step(here, ds, next).converged());
      back = closed.on_step(here, next, ds);
      if (back) break;
      closed.add_step(ds);
      length += ds;
      std::swap(here, next);
    }
    REQUIRE(back);
    REQUIRE(orbits.follower.step(back->from, back->length, next).converged());
    CHECK(std::abs(next.orbit.par(0)) < 1e-8);
    CHECK(radius(next.orbit) == Approx(2.5).epsilon(1e-8));
  }
}

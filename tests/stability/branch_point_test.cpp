// Branch points are located, labelled once and passed, whatever the step, its direction, the tolerance and the mesh:
// right on top of one the Newton matrix is singular, and a trial step there may fail or come out anywhere near.
#include <catch2/catch.hpp>

#include "impacting_orbits.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

/// The unit circle with a third state z, and w = z - k mu^2: field 1 (pitchfork) w' = mu w - w^3, field 2
/// (transcritical) w' = mu w - w^2. PAR(1) = mu, PAR(2) = k bends the branch w = 0.
struct BentForms {
  static constexpr int dimension = 3, parameters = 2, fields = 2, events = 1, jumps = 1;
  template <class T>
  void field(int i, const T* u, const T* p, T* f) const {
    const T growth = 1.0 - u[0] * u[0] - u[1] * u[1];
    const T w = u[2] - p[1] * p[0] * p[0];
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
    f[2] = i == 1 ? p[0] * w - w * w * w : p[0] * w - w * w;
  }
  template <class T>
  T event(int, const T* u, const T*) const {
    return u[1];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    g[0] = u[0], g[1] = u[1], g[2] = u[2];
  }
};

struct Variant {
  double step = 0.03;
  double bend = 0.0;
  double tolerance = 1e-10;  ///< of Newton's corrections and of the location
  int intervals = 20;
  int collocation = 4;
  double from = 0.2;  ///< distance of the start
};

/// From one side of the branch point at mu = 0 to the other one; `w0` is w at the start (0: the known branch).
RecordedBranch across(int field, const Variant& v, double w0 = 0.0) {
  const double mu = v.step > 0.0 ? -v.from : v.from;
  const auto state = [=](double t) {
    return Eigen::VectorXd(Eigen::Vector3d(std::cos(pi + t), std::sin(pi + t), v.bend * mu * mu + w0));
  };
  const Orbit start = sampled_orbit({{2 * pi, state}}, 3, v.intervals, v.collocation, parameters({mu, v.bend}));
  PeriodicOrbits orbits(system_of<BentForms>(), {{field, 1, 1}}, 1, start.shape, {8, 3, v.tolerance, v.tolerance});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, v.step, std::abs(v.step), 2000);
  settings.step.max_newton = 8;
  settings.location_tolerance = v.tolerance;
  settings.parameter_min = -0.21;
  settings.parameter_max = 0.21;
  Tests tests;
  tests.push_back(std::make_unique<FoldTest>(1, orbits.system.free_parameters(), ParameterLayout(), 1, false));
  tests.push_back(std::make_unique<BranchPointTest>(false));
  tests.push_back(std::make_unique<PeriodDoublingTest>(false));
  tests.push_back(std::make_unique<TorusTest>(false));
  return record(orbits.follower, orbits.system, point, settings, std::move(tests));
}

/// Steps from 20 times smaller to 20 times larger than 0.03, both ways.
std::vector<double> steps() {
  std::vector<double> result;
  for (int k = -10; k <= 10; ++k)
    for (const double sign : {1.0, -1.0}) result.push_back(sign * 0.03 * std::pow(20.0, k / 10.0));
  return result;
}

/// Nothing but shorter steps.
bool only_retries(const RecordedBranch& branch) {
  return std::all_of(branch.notes.begin(), branch.notes.end(),
                     [](const std::string& note) { return note.find("Retrying step") == 0; });
}

void check_passed(int field, const Variant& v) {
  CAPTURE(field, v.step, v.bend, v.tolerance, v.intervals, v.collocation, v.from);
  const RecordedBranch branch = across(field, v);
  const auto found = branch.special();
  CAPTURE(branch.notes);
  CHECK(found.size() == 1);
  if (found.size() != 1) return;
  CHECK(found[0]->special.type == PointType::branch_point);
  CHECK(std::abs(found[0]->orbit.par(0)) < 1e-6);
  CHECK(only_retries(branch));
  // On the known branch still, and across.
  const Orbit& last = branch.points.back().orbit;
  CHECK(last.par(0) * v.step > 0.0);
  for (const RecordedPoint& p : branch.points)
    CHECK(std::abs(p.orbit.start(0)[2] - v.bend * p.orbit.par(0) * p.orbit.par(0)) < 1e-6);
}

}  // namespace

TEST_CASE("branch point: located and passed with steps 20 times smaller and larger, straight and bent branches",
          "[slow]") {
  for (const double bend : {0.0, 1.0, 5.0})
    for (const int field : {1, 2})
      for (const double step : steps()) {
        if (bend * std::abs(step) > 0.3) continue;  // about the radius of curvature: another branch is as near
        check_passed(field, {.step = step, .bend = bend});
      }
}

TEST_CASE("branch point: located and passed on several meshes, with usual and with tight tolerances", "[slow]") {
  for (const int field : {1, 2})
    for (const double tolerance : {1e-7, 1e-10, 1e-12})
      for (const double step : {0.013, -0.04, 0.1})
        for (const int intervals : {10, 20, 50, 100})
          for (const int collocation : {3, 4, 6})
            check_passed(field, {.step = step,
                                 .bend = 1.0,
                                 .tolerance = tolerance,
                                 .intervals = intervals,
                                 .collocation = collocation});
}

TEST_CASE("branch point: located and passed wherever the steps fall") {
  for (const int field : {1, 2})
    for (int k = 0; k < 40; ++k) check_passed(field, {.step = 0.03, .bend = 2.0, .from = 0.15 + 0.001 * k});
}

TEST_CASE("branch point: seen from the other branches too, where a pitchfork is a fold") {
  for (const double step : {0.011, -0.011, 0.03, -0.03, 0.1, -0.1}) {
    CAPTURE(step);
    const Variant variant{.step = step, .from = step > 0.0 ? 0.2 : 0.19};
    // Transcritical: w = mu.
    const RecordedBranch other = across(2, variant, step > 0.0 ? -0.2 : 0.19);
    REQUIRE(other.special().size() == 1);
    CHECK(other.special()[0]->special.type == PointType::branch_point);
    CHECK(std::abs(other.special()[0]->orbit.par(0)) < 1e-6);
    CHECK(only_retries(other));
  }
}

TEST_CASE("branch point: {J1, J1} where {J1} doubles its period, with steps of any length from both sides", "[slow]") {
  for (const double v : {0.06, 0.02}) {
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, v);
    const CutOrbit cut = twice(orbit);
    for (const int intervals : {25, 50})
      for (int k = -10; k <= 10; ++k) {
        const double largest = 0.01 * std::pow(20.0, k / 10.0);
        CAPTURE(v, largest, intervals);
        const Orbit start = sampled_orbit(cut.pieces, 4, intervals, 4, orbit.par());
        PeriodicOrbits orbits(linosc(), cut.signature, 1, start.shape, {8, 3, 1e-10, 1e-10});
        const PathPoint point = orbits.corrected(start);
        REQUIRE(orbits.result.converged());
        const double way = v > 0.04 ? -1.0 : 1.0;
        ContinuationSettings settings = branch_settings(start.shape, 1, way * std::min(largest, 0.02), largest, 500);
        settings.step.max_newton = 8;
        settings.location_tolerance = 1e-9;
        settings.stop_at = [](const SpecialPoint&) { return true; };
        Tests tests;
        tests.push_back(std::make_unique<BranchPointTest>(false));
        tests.push_back(std::make_unique<PeriodDoublingTest>(false));
        const RecordedBranch branch = record(orbits.follower, orbits.system, point, settings, std::move(tests));
        CAPTURE(branch.notes);
        CHECK(branch.special().size() == 1);
        if (branch.special().size() != 1) continue;
        CHECK(branch.special()[0]->special.type == PointType::branch_point);
        CHECK(branch.special()[0]->orbit.par(0) == Approx(doubling_alpha).margin(1e-6).epsilon(0));
        CHECK(only_retries(branch));
      }
  }
}

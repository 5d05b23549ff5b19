// Turning points that are no folds of orbits, and ends that a branch has of itself: a section that becomes tangent, an
// orbit that shrinks to an equilibrium, a period without bound, a torus curve beyond its 1:1 resonance.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <map>

#include "continuation/orbit_trend.hpp"
#include "orbit/curve_conditions.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/curve_tests.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;

namespace {

/// One field, sections that are states, the identity.
template <class Field, int n, int section>
struct Cut {
  static constexpr int dimension = n, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    Field::value(x, p, f);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[section];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < n; ++i) g[i] = x[i];
  }
};

/// Circles of radius sqrt(mu), period 2 pi.
struct HopfField {
  template <class T>
  static void value(const T* x, const T* p, T* f) {
    const T growth = p[0] - x[0] * x[0] - x[1] * x[1];
    f[0] = x[0] * growth - x[1];
    f[1] = x[1] * growth + x[0];
  }
};

/// Orbits around (1, 0) that end at a homoclinic orbit of (0, 0) as mu grows to -0.86454525.
struct HomoclinicField {
  template <class T>
  static void value(const T* x, const T* p, T* f) {
    f[0] = x[1];
    f[1] = x[0] - x[0] * x[0] + p[0] * x[1] + x[0] * x[1];
  }
};

/// The unit circle, turned with the rate p1.
struct ScaledField {
  template <class T>
  static void value(const T* x, const T* p, T* f) {
    const T growth = 1.0 - x[0] * x[0] - x[1] * x[1];
    f[0] = p[0] * (x[0] * growth - x[1]);
    f[1] = p[0] * (x[1] * growth + x[0]);
  }
};

/// Bogdanov's normal form beside a rotation of period 2 pi: with the equilibrium x = 0, y = 0 at p1 = 0 the multipliers
/// exp(+-2 pi sqrt(p2)), a torus curve for p2 < 0 and neutral saddles for p2 > 0.
struct BogdanovField {
  template <class T>
  static void value(const T* x, const T* p, T* f) {
    f[0] = x[1];
    f[1] = p[0] + p[1] * x[0] + x[0] * x[0] - x[0] * x[1];
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[2] = x[2] * growth - x[3];
    f[3] = x[3] * growth + x[2];
  }
};

/// Takens' normal form with x -> -x beside a rotation of period 2 pi. The equilibria x = +-a, y = 0 at p1 = p2 = a^2
/// have the eigenvalues +-i sqrt(2) a, so multipliers exp(+-2 pi i sqrt(2) a): a torus curve that meets its mirror
/// image where a = 0, in the 1:1 resonance, at the torus curve p1 < 0, p2 = 0 of the orbit x = 0.
struct TakensField {
  template <class T>
  static void value(const T* x, const T* p, T* f) {
    f[0] = x[1];
    f[1] = p[0] * x[0] + p[1] * x[1] - x[0] * x[0] * (x[0] + x[1]);
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[2] = x[2] * growth - x[3];
    f[3] = x[3] * growth + x[2];
  }
};

using Tests = std::vector<std::unique_ptr<TestFunction>>;

Tests folds_and_sections(const DefiningSystem& system, bool stop) {
  Tests tests;
  for (int s = 0; s < system.segments(); ++s) tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, stop));
  tests.push_back(std::make_unique<FoldTest>(1, system.free_parameters(), ParameterLayout(), system.segments(), false));
  return tests;
}

int folds(const KeepingSink& sink) {
  int count = 0;
  for (const KeptPoint& p : sink.points) count += p.special.type == PointType::fold;
  return count;
}

/// One impact of velocity v in two periods of the forcing.
OscillatorOrbit one_impact_in_two_periods(double omega, double v) {
  const OscillatorConstants k{omega};
  const Eigen::Vector2d jump(0.0, (1 + k.r) * v);
  const Eigen::Vector2d u0 = (k.homogeneous(2 * k.period()) - Eigen::Matrix2d::Identity()).partialPivLu().solve(jump);
  const std::complex<double> forcing = std::complex<double>{1 - u0(0), (k.r * v + u0(1)) / omega} * k.stiffness();
  return {k, std::abs(forcing), std::arg(forcing), u0};
}

/// The time of the first maximum of x1 after the impact.
double first_maximum(const OscillatorOrbit& orbit, double most) {
  const auto velocity = [&](double t) { return orbit.state(t)(1); };
  constexpr int steps = 4000;
  for (int k = 1; k < steps; ++k) {
    double low = most * k / steps, high = most * (k + 1) / steps;
    if (!(velocity(low) > 0.0 && velocity(high) <= 0.0)) continue;
    for (int i = 0; i < 60; ++i) (velocity(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
    return low;
  }
  return 0.0;
}

}  // namespace

TEST_CASE("a section that becomes tangent turns the branch: it is named, and no fold of orbits") {
  const bool stop = GENERATE(true, false);
  CAPTURE(stop);
  const OscillatorOrbit orbit = one_impact_in_two_periods(3.8, 5.2);
  const double period = 2 * orbit.constants.period();
  const double maximum = first_maximum(orbit, period);
  REQUIRE(maximum > 0.0);
  const OrbitShape shape{4, 2, 30, 4};
  PeriodicOrbits orbits(linosc(), {{1, 1, 1}, {1, 2, 2}}, 1, shape);
  const PathPoint start =
      orbits.corrected(sampled_orbit({orbit.piece(maximum, period), orbit.piece(0.0, maximum)}, 4, 30, 4, orbit.par()));
  REQUIRE(orbits.result.converged());
  const double direction = one_impact_in_two_periods(3.8, 5.3).alpha > orbit.alpha ? 1.0 : -1.0;
  ContinuationSettings settings = branch_settings(shape, 1, 0.02 * direction, 0.1, 60);
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, folds_and_sections(orbits.system, stop), sink);
  const BranchSummary summary = run.run(start);
  CHECK(folds(sink) == 0);
  const auto tangent = std::find_if(sink.points.begin(), sink.points.end(),
                                    [](const KeptPoint& p) { return p.special.type == PointType::user; });
  REQUIRE(tangent != sink.points.end());
  CHECK(tangent->special.kind.kind == UserPointKind::impact_velocity);
  CHECK(tangent->special.kind.segment == 2);
  CHECK_THAT(tangent->special.description, Contains("section tangent") && !Contains("; fold"));
  CHECK(tangent->orbit.par(0) == Approx(8.7197).epsilon(1e-4));
  CHECK((summary.reason == EndReason::special_point) == stop);
  if (!stop) CHECK(sink.points.end() - tangent > 5);
}

TEST_CASE("a branch that shrinks to an equilibrium ends there, and is not retraced") {
  using Hopf = Cut<HopfField, 2, 1>;
  const double largest = GENERATE(0.01, 0.05, 0.1);
  const double tolerance = GENERATE(1e-7, 1e-9);
  const bool with_tests = GENERATE(true, false);
  CAPTURE(largest, tolerance, with_tests);
  const OrbitShape shape{2, 1, 20, 4};
  PeriodicOrbits orbits(system_of<Hopf>(), {{1, 1, 1}}, 1, shape);
  const auto circle = [](double t) { return Eigen::Vector2d(-0.5 * std::cos(t), -0.5 * std::sin(t)); };
  const PathPoint start = orbits.corrected(sampled_orbit({{2 * pi, circle}}, 2, 20, 4, parameters({0.25})));
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(shape, 1, -largest, largest, 300);
  settings.location_tolerance = tolerance;
  settings.adapt_mesh_every = 3;
  KeepingSink sink;
  Tests tests = folds_and_sections(orbits.system, true);
  if (!with_tests) tests.pop_back();
  ContinuationRun run(orbits.follower, orbits.system, settings, std::move(tests), sink);
  const BranchSummary summary = run.run(start);
  INFO(summary.detail);
  CHECK(summary.reason == EndReason::equilibrium);
  CHECK(folds(sink) == 0);
  CHECK(sink.points.back().special.type == PointType::hopf);
  CHECK(std::abs(sink.points.back().orbit.par(0)) < 1e-8);
  CHECK(sink.points.back().orbit.period() == Approx(2 * pi).epsilon(1e-6));
}

TEST_CASE("a parameter that tends to a limit while the period grows does not turn there") {
  using Homoclinic = Cut<HomoclinicField, 2, 1>;
  const HybridSystem& system = system_of<Homoclinic>();
  const int intervals = GENERATE(40, 100);
  CAPTURE(intervals);
  const ParameterVector par = parameters({-0.95});
  const PeriodicOrbit cycle = shoot(system, {{1, 1, 1}}, Eigen::Vector2d(1.3737, 0.0), par, ShootingOptions{});
  REQUIRE(cycle.converged);
  const OrbitShape shape{2, 1, intervals, 4};
  PeriodicOrbits orbits(system, {{1, 1, 1}}, 1, shape, {8, 3, 1e-8, 1e-8});
  const PathPoint start =
      orbits.corrected(sampled_orbit(pieces_of(system, {{1, 1, 1}}, cycle.map, par), 2, intervals, 4, par));
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(shape, 1, 0.02, 0.2, 200);
  settings.adapt_mesh_every = 3;
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, folds_and_sections(orbits.system, true), sink);
  const BranchSummary summary = run.run(start);
  CHECK(folds(sink) == 0);
  CHECK(sink.points.back().orbit.period() > 40.0);
  CHECK(sink.points.back().orbit.par(0) == Approx(-0.8645452).epsilon(1e-6));
  // The saddle has lambda^2 - mu lambda - 1 = 0.
  CHECK_THAT(summary.remark, Contains("period grows") && Contains("homoclinic") && Contains("U(1) = 0, U(2) = 0") &&
                                 Contains("-1.5217") && Contains("0.65715"));
}

TEST_CASE("a period that grows with nothing at rest nearby tends to no homoclinic orbit") {
  using Scaled = Cut<ScaledField, 2, 1>;
  const OrbitShape shape{2, 1, 20, 4};
  PeriodicOrbits orbits(system_of<Scaled>(), {{1, 1, 1}}, 1, shape);
  const auto orbit = [&](double rate) {
    const auto circle = [=](double t) { return Eigen::Vector2d(-std::cos(rate * t), -std::sin(rate * t)); };
    return sampled_orbit({{2 * pi / rate, circle}}, 2, 20, 4, parameters({rate}));
  };
  OrbitTrend trend;
  for (const double rate : {5e-7, 4e-7, 2e-7}) trend.add(orbit(rate), rate, 1.0);
  const auto growth = trend.period_growth();
  REQUIRE(growth);
  CHECK(growth->from == Approx(2 * pi / 5e-7));
  CHECK(growth->to == Approx(2 * pi / 2e-7));
  CHECK(homoclinic_limit(orbits.system, orbit(2e-7), *growth, "rate") == "");
}

TEST_CASE("a negative period does not grow") {
  const auto still = [](double) { return Eigen::Vector2d(1.0, 0.0); };
  OrbitTrend trend;
  for (const double period : {-6.227, -6.227, -3.0}) {
    trend.add(sampled_orbit({{period, still}}, 2, 5, 4, parameters({0.3})), 0.3, 1.0);
    CHECK_FALSE(trend.period_growth());
  }
}

TEST_CASE("beyond the 1:1 resonance that it begins at a torus curve ends, it does not follow neutral saddles") {
  using Bogdanov = Cut<BogdanovField, 4, 3>;
  const HybridSystem& system = system_of<Bogdanov>();
  const double direction = GENERATE(1.0, -1.0);
  CAPTURE(direction);
  const auto state = [](double t) { return Eigen::Vector4d(0.0, 0.0, -std::cos(t), -std::sin(t)); };
  const OrbitShape shape{4, 1, 10, 4};
  const PeriodicOrbitSystem defining(system, {{1, 1, 1}}, {2, 1});
  auto pair = std::make_unique<CriticalPair>(defining, shape, std::polar(1.0, 2 * pi * std::sqrt(1e-6)));
  const CriticalPair& condition = *pair;
  PathFollower follower(defining, shape, WeightedNorm::unit(shape), tight_newton(), 2, std::move(pair));
  PathPoint start = follower.make_point(sampled_orbit({{2 * pi, state}}, 4, 10, 4, parameters({0.0, -1e-6})));
  REQUIRE(follower.start_at_fixed_parameter(start).converged());
  Tests tests;
  if (direction < 0.0) tests = torus_curve_tests(condition);
  const ContinuationSettings settings = branch_settings(shape, 2, 1e-3 * direction, 5e-3, 15);
  KeepingSink sink;
  ContinuationRun run(follower, defining, settings, std::move(tests), sink);
  const BranchSummary summary = run.run(start);
  CHECK((summary.reason == EndReason::curve_end) == (direction > 0.0));
  CHECK((sink.points.size() == 2) == (direction > 0.0));
  if (direction > 0.0) CHECK_THAT(summary.detail, Contains("neutral saddles") && Contains("1:1"));
}

TEST_CASE("a torus curve that meets its mirror image ends there, in the 1:1 resonance, with short and long steps") {
  using Takens = Cut<TakensField, 4, 3>;
  const double longest = GENERATE(0.003, 0.01, 0.1, 0.5);
  const double direction = GENERATE(1.0, -1.0);  // of p2 at the start: to the resonance where it falls
  const double mirror = GENERATE(1.0, -1.0);
  CAPTURE(longest, direction, mirror);
  constexpr double a = 0.2;
  const auto state = [=](double t) { return Eigen::Vector4d(mirror * a, 0.0, -std::cos(t), -std::sin(t)); };
  const OrbitShape shape{4, 1, 10, 4};
  const PeriodicOrbitSystem defining(system_of<Takens>(), {{1, 1, 1}}, {2, 1});
  auto pair = std::make_unique<CriticalPair>(defining, shape, std::polar(1.0, 2 * pi * std::sqrt(2.0) * a));
  const CriticalPair& condition = *pair;
  PathFollower follower(defining, shape, WeightedNorm::unit(shape), tight_newton(), 2, std::move(pair));
  PathPoint start = follower.make_point(sampled_orbit({{2 * pi, state}}, 4, 10, 4, parameters({a * a, a * a})));
  REQUIRE(follower.start_at_fixed_parameter(start).converged());
  Tests tests = torus_curve_tests(condition);
  const double rising = follower.principal_direction(start) > 0.0 ? direction : -direction;
  ContinuationSettings settings = branch_settings(shape, 2, 0.5 * longest * rising, longest, 600);
  settings.parameter_max = 0.4;
  KeepingSink sink;
  ContinuationRun run(follower, defining, settings, std::move(tests), sink);
  const BranchSummary summary = run.run(start);
  CHECK(summary.lost.empty());
  std::map<PointType, double> found;  // p2
  for (const KeptPoint& point : sink.points)
    if (point.special.type != PointType::ordinary && point.special.type != PointType::end)
      // The angle passes 1:3 twice, at 2 pi / 3 and 4 pi / 3.
      CHECK((found.emplace(point.special.type, point.orbit.par(1)).second ||
             point.special.type == PointType::resonance_3));
  if (direction < 0.0) {
    REQUIRE(found.count(PointType::resonance_1) == 1);
    CHECK(summary.reason == EndReason::special_point);
    CHECK(std::abs(found[PointType::resonance_1]) < 1e-8);
    CHECK(found[PointType::resonance_4] == Approx(1.0 / 32.0).epsilon(1e-6));
    CHECK(sink.points.back().orbit.states.topRows(2).cwiseAbs().maxCoeff() < 1e-4);
  } else {
    // sqrt(2) a = 1/2: L = -Id, which the angle passes without a label
    CHECK(found.count(PointType::resonance_2) == 0);
    CHECK(found[PointType::resonance_4] == Approx(9.0 / 32.0).epsilon(1e-6));
  }
}

// The impacting branch of the linear oscillator against its closed form and against forward integration.
#include <catch2/catch.hpp>

#include "motion/orbit_flow.hpp"
#include "stability/test_function.hpp"
#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/multiplier_sets.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const Signature impacting{{1, 1, 1}};

std::vector<KeptPoint> continued(double omega, double v, double ds, int count, const std::vector<double>& user_values,
                                 int adapt_mesh_every = 3) {
  const OscillatorOrbit orbit = one_impact_orbit(omega, v);
  const Orbit start = sampled_orbit({orbit.piece(0, orbit.constants.period())}, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), impacting, 1, start.shape);
  PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, ds, 0.2, count);
  settings.adapt_mesh_every = adapt_mesh_every;
  settings.location_tolerance = 1e-12;
  settings.max_location = 30;
  std::vector<std::unique_ptr<TestFunction>> tests;
  for (const double value : user_values) tests.push_back(std::make_unique<UserValueTest>(1, value, false, "alpha"));
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, std::move(tests), sink);
  run.run(point);
  return sink.points;
}

void check_conditions(const KeptPoint& point) {
  const Orbit& x = point.orbit;
  const double v = x.end(0)[1];
  const OscillatorOrbit exact = one_impact_orbit(x.par(1), v);
  CAPTURE(point.number, v, x.par(0));
  // The conditions of the header of support/linear_oscillator.hpp, each to 1e-9.
  CHECK(std::abs(x.start(0)[0] - 1.0) < 1e-9);
  CHECK(std::abs(x.end(0)[0] - 1.0) < 1e-9);
  CHECK(std::abs(x.start(0)[1] + 0.8 * v) < 1e-9);
  CHECK(std::abs(x.period() - 2 * pi / x.par(1)) < 1e-9);
  CHECK(std::abs(x.par(0) - exact.alpha) < 1e-9);
  const Orbit closed = sampled_orbit({exact.piece(0, exact.constants.period())}, 4, x.shape.intervals,
                                     x.shape.collocation, x.par, x.mesh);
  CHECK(mesh_point_distance(x, closed) < 1e-9 * (1 + x.states.cwiseAbs().maxCoeff()));
}

void check_multipliers(const KeptPoint& point) {
  const Orbit& x = point.orbit;
  const double v = x.end(0)[1];
  CAPTURE(point.number, v, x.par(0));
  // 1e-7: the orbit's own error of 1e-10 times |f| / |h_x f| ~ 4 / v squared, as v enters the saltation.
  REQUIRE(point.multipliers.valid);
  CHECK(mixed_distance(point.multipliers.values, one_impact_multipliers(x.par(1), v)) < 1e-7);
  // Forward integration finds an impact at a velocity of less than 0.01 with a relative error of tolerance / v^2.
  if (v < 0.01) return;
  FlowOptions options;
  options.relative_tolerance = 1e-12;
  options.absolute_tolerance = 1e-12;
  const ReturnMap map =
      return_map(linosc(), impacting, Eigen::Map<const Eigen::VectorXd>(x.start(0), 4), x.par, options);
  REQUIRE(map.ok);
  const Multipliers integrated(map.multipliers.begin(), map.multipliers.end());
  CHECK(mixed_distance(point.multipliers.values, integrated) < 1e-7);
}

struct Row {
  double omega, v, alpha, y1, y2;
  Multipliers nontrivial;
};

const std::vector<Row> published{
    {2.0072, 0.01, 3.03570284598397, 0.0669690800277, -0.997755051263, {-0.058488566665, -8.0013040443}},
    {2.0072,
     0.5,
     3.04852587939213,
     0.108128110009,
     -0.994136968343,
     {{0.5896957647, 0.34676174832}, {0.5896957647, -0.34676174832}}},
    {2.0072,
     5,
     3.39159789647371,
     0.439271830566,
     -0.898354194553,
     {{0.67454541497, 0.11390034304}, {0.67454541497, -0.11390034304}}},
    {1.8901, 1, 2.38541057447103, 0.175147630331, -0.984542181722, {2.0129136551, 0.22802581492}},
    {1.8901, 8, 2.16507472824774, 0.932680082374, -0.360704676908, {0.86018166947, 0.53360388028}},
};

}  // namespace

TEST_CASE("closed form of the one-impact orbit agrees with the published table") {
  for (const Row& row : published) {
    CAPTURE(row.omega, row.v);
    const OscillatorOrbit orbit = one_impact_orbit(row.omega, row.v);
    CHECK(orbit.alpha == Approx(row.alpha).epsilon(1e-13));
    CHECK(std::sin(orbit.theta0) == Approx(row.y1).epsilon(1e-11));
    CHECK(std::cos(orbit.theta0) == Approx(row.y2).epsilon(1e-11));
    const Multipliers all = one_impact_multipliers(row.omega, row.v);
    CHECK(relative_distance({all[0], all[1]}, row.nontrivial) < 1e-9);
  }
}

TEST_CASE("impacting branch: every point is a one-impact orbit, multipliers as integration finds them") {
  struct Part {
    double omega, v, ds;
  };
  const Part part =
      GENERATE(Part{2.0072, 0.5, 0.01}, Part{2.0072, 0.1, -0.002}, Part{1.8901, 1.0, -0.02}, Part{1.8901, 1.0, 0.02});
  CAPTURE(part.omega, part.v, part.ds);
  const std::vector<KeptPoint> points = continued(part.omega, part.v, part.ds, 40, {});
  REQUIRE(points.size() == 40);
  for (const KeptPoint& point : points) {
    check_conditions(point);
    if (point.orbit.end(0)[1] > 1e-3) check_multipliers(point);
  }
}

TEST_CASE("impacting branch: the rows of the published table are reached as user values of alpha") {
  for (const Row& row : published) {
    CAPTURE(row.omega, row.v);
    // From another orbit of the branch, half as far from grazing, on to the row and beyond it.
    const double from = row.v > 1 ? 0.7 * row.v : 2 * row.v;
    const double towards = row.v > from ? 1.0 : -1.0;
    const double slope = one_impact_orbit(row.omega, 1.001 * from).alpha - one_impact_orbit(row.omega, from).alpha;
    const std::vector<KeptPoint> points =
        continued(row.omega, from, (slope > 0 ? 1 : -1) * towards * 0.1 * std::min(row.v, 1.0), 60, {row.alpha});
    const KeptPoint* found = nullptr;
    for (const KeptPoint& point : points)
      if (point.special.type == PointType::user && std::abs(point.orbit.end(0)[1] - row.v) < 0.1 * row.v)
        found = &point;
    REQUIRE(found != nullptr);
    const Orbit& x = found->orbit;
    // Located to 1e-12 of arclength; discretised to 1e-10.
    CHECK(x.par(0) == Approx(row.alpha).epsilon(1e-10));
    CHECK(x.end(0)[1] == Approx(row.v).margin(1e-8));
    CHECK(x.start(0)[2] == Approx(row.y1).margin(1e-9));
    CHECK(x.start(0)[3] == Approx(row.y2).margin(1e-9));
    const Multipliers expected{row.nontrivial[0], row.nontrivial[1], std::exp(-2 * x.period()), 0.0};
    CHECK(mixed_distance(found->multipliers.values, expected) < 1e-7);
  }
}

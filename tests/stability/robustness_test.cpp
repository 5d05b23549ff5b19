// Grazing, period doubling and fold of the linear oscillator are found at the same place whatever the mesh, the step,
// the direction and the cuts of the orbit.
#include <catch2/catch.hpp>

#include "impacting_orbits.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "recorded_branch.hpp"
#include "stability/bifurcation_tests.hpp"
#include "stability/grazing_tests.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

enum class Cut { none, minimum_first, impact_first, twice };

struct Variant {
  int intervals = 50;
  int collocation = 4;
  double largest_step = 0.1;
  double side =
      1.0;  ///< the branch is started at larger values of the parameter or impact velocity, or at smaller ones
  Cut cut = Cut::none;
  int adapt_mesh_every = 3;
};

CutOrbit cut_orbit(const OscillatorOrbit& orbit, Cut cut) {
  switch (cut) {
    case Cut::minimum_first:
      return cut_at_minimum(orbit, false);
    case Cut::impact_first:
      return cut_at_minimum(orbit, true);
    case Cut::twice:
      return twice(orbit);
    default:
      return whole(orbit);
  }
}

/// Continued with AUTO's usual ITMX until `enough`.
RecordedBranch continued(const HybridSystem& hybrid, const CutOrbit& cut, const ParameterVector& par, int principal,
                         double ds, const Variant& variant, const std::function<Tests(const DefiningSystem&)>& tests,
                         int points) {
  const Orbit start = sampled_orbit(cut.pieces, 4, variant.intervals, variant.collocation, par);
  PeriodicOrbits orbits(hybrid, cut.signature, principal, start.shape, {12, 4, 1e-10, 1e-10});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, principal, ds, variant.largest_step, points);
  settings.adapt_mesh_every = variant.adapt_mesh_every;
  settings.location_tolerance = 1e-9;
  settings.max_location = 10;
  settings.stop_at = [](const SpecialPoint&) { return true; };
  return record(orbits.follower, orbits.system, point, settings, tests(orbits.system));
}

constexpr int enough = 3000;

/// The nonimpacting orbit from its maximum; cut at its minimum, half a period later, the contact is at the joint.
CutOrbit cut_nonimpacting_orbit(const OscillatorOrbit& orbit, Cut cut) {
  const double period = orbit.constants.period();
  const Piece falling = orbit.piece(0, period / 2), rising = orbit.piece(period / 2, period);
  switch (cut) {
    case Cut::minimum_first:
      return {{{1, 3, 2}, {1, 2, 2}}, {falling, rising}};
    case Cut::impact_first:
      return {{{1, 2, 2}, {1, 3, 2}}, {rising, falling}};
    case Cut::twice:
      return {{{1, 2, 2}, {1, 2, 2}}, {orbit.piece(0, period), orbit.piece(0, period)}};
    default:
      return {{{1, 2, 2}}, {orbit.piece(0, period)}};
  }
}

/// omega of the grazing of the nonimpacting orbit at alpha = 3.
double grazing(const Variant& variant) {
  // Towards smaller omega into grazing, or back from the inadmissible side: far enough for one step of the largest.
  const double from = variant.side > 0 ? 2.0 : 1.997;
  const OscillatorOrbit orbit = nonimpacting_orbit(from, 3.0);
  const double ds = -variant.side * std::min(0.002, variant.largest_step);
  const RecordedBranch branch = continued(
      linosc(), cut_nonimpacting_orbit(orbit, variant.cut), orbit.par(), 2, ds, variant,
      [](const DefiningSystem& system) {
        Tests tests;
        for (int s = 0; s < system.segments(); ++s) tests.push_back(std::make_unique<ContactTest>(system, s, 1, true));
        return tests;
      },
      enough);
  const auto found = branch.special();
  REQUIRE(found.size() == 1);
  CHECK(found[0]->special.kind.kind == UserPointKind::contact);
  return found[0]->orbit.par(1);
}

/// alpha of the bifurcation of the impacting orbit at fixed omega.
double bifurcation(double omega, double from, PointType type, double ds, const Variant& variant) {
  const OscillatorOrbit orbit = one_impact_orbit(omega, from);
  const RecordedBranch branch = continued(
      linosc(), cut_orbit(orbit, variant.cut), orbit.par(), 1, ds, variant,
      [](const DefiningSystem& system) {
        Tests tests;
        tests.push_back(
            std::make_unique<FoldTest>(1, system.free_parameters(), ParameterLayout(), system.segments(), false));
        tests.push_back(std::make_unique<BranchPointTest>(false));
        tests.push_back(std::make_unique<PeriodDoublingTest>(false));
        tests.push_back(std::make_unique<TorusTest>(false));
        for (int s = 0; s < system.segments(); ++s)
          tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, true));
        return tests;
      },
      enough);
  const auto found = branch.special();
  REQUIRE(found.size() == 1);
  CHECK(found[0]->special.type == type);
  // The critical multiplier is what the type says: +1 (a branch point of the orbit passed twice, too) or -1.
  const double critical = type == PointType::period_doubling ? -1.0 : 1.0;
  double nearest = 1.0;
  for (const auto& mu : found[0]->multipliers.values) nearest = std::min(nearest, std::abs(mu - critical));
  if (variant.intervals >= 50 && variant.collocation >= 4) CHECK(nearest < 1e-6);
  return found[0]->orbit.par(0);
}

double doubling(const Variant& variant) {
  const double v = variant.side > 0 ? 0.2 : 0.02;
  const double sign = one_impact_orbit(2.0072, 1.01 * v).alpha > one_impact_orbit(2.0072, v).alpha ? 1.0 : -1.0;
  return bifurcation(2.0072, v, variant.cut == Cut::twice ? PointType::branch_point : PointType::period_doubling,
                     -variant.side * sign * std::min(0.005, variant.largest_step), variant);
}

double fold(const Variant& variant) {
  const double v = variant.side > 0 ? 6.5 : 4.0;
  const double sign = one_impact_orbit(1.8901, 1.01 * v).alpha > one_impact_orbit(1.8901, v).alpha ? 1.0 : -1.0;
  return bifurcation(1.8901, v, PointType::fold, -variant.side * sign * std::min(0.05, variant.largest_step), variant);
}

void check_all(const Variant& variant, double tolerance) {
  CAPTURE(variant.intervals, variant.collocation, variant.largest_step, variant.side, static_cast<int>(variant.cut));
  CHECK(doubling(variant) == Approx(doubling_alpha).margin(tolerance).epsilon(0));
  CHECK(fold(variant) == Approx(fold_alpha).margin(tolerance).epsilon(0));
  CHECK(grazing(variant) == Approx(grazing_omega).margin(tolerance).epsilon(0));
}

}  // namespace

TEST_CASE("location does not depend on the mesh", "[slow]") {
  for (const int intervals : {50, 100, 200})
    for (const int collocation : {4, 5, 6}) check_all({.intervals = intervals, .collocation = collocation}, 1e-7);
}

TEST_CASE("location on a coarse mesh") {
  for (const int adapt : {0, 3}) check_all({.intervals = 20, .collocation = 3, .adapt_mesh_every = adapt}, 1e-5);
}

TEST_CASE("location converges at the order of mesh points") {
  for (const int collocation : {2, 3}) {
    const double order = 2 * collocation;
    CAPTURE(collocation);
    struct Place {
      double (*locate)(const Variant&);
      double exact;
    };
    for (const Place& place :
         {Place{doubling, doubling_alpha}, Place{fold, fold_alpha}, Place{grazing, grazing_omega}}) {
      std::vector<double> errors;
      for (const int intervals : {12, 24})
        errors.push_back(std::abs(
            place.locate({.intervals = intervals, .collocation = collocation, .adapt_mesh_every = 0}) - place.exact));
      CAPTURE(place.exact, errors[0], errors[1]);
      CHECK(std::log2(errors[0] / errors[1]) == Approx(order).margin(0.5));
    }
  }
}

TEST_CASE("location does not depend on the step or its direction") {
  for (const double side : {1.0, -1.0})
    for (const double largest_step : {0.005, 0.1, 2.0}) check_all({.largest_step = largest_step, .side = side}, 1e-7);
}

TEST_CASE("location does not depend on the cuts of the orbit") {
  for (const double side : {1.0, -1.0})
    for (const Cut cut : {Cut::minimum_first, Cut::impact_first, Cut::twice})
      check_all({.side = side, .cut = cut}, 1e-7);
}

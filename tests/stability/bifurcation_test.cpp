// Test functions of bifurcations against normal forms and the closed forms of the linear oscillator.
#include "stability/bifurcation_tests.hpp"

#include <catch2/catch.hpp>

#include "impacting_orbits.hpp"
#include "langford.hpp"
#include "normal_forms.hpp"
#include "orbit/periodic_orbit_system.hpp"
#include "recorded_branch.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

enum Which : std::size_t { fold, branch_point, doubling, torus, velocity };

/// All bifurcation tests, in the order of Which, then the impact velocity of every segment.
Tests all_tests(const DefiningSystem& system, int principal) {
  Tests tests;
  tests.push_back(
      std::make_unique<FoldTest>(principal, system.free_parameters(), ParameterLayout(), system.segments(), false));
  tests.push_back(std::make_unique<BranchPointTest>(false));
  tests.push_back(std::make_unique<PeriodDoublingTest>(false));
  tests.push_back(std::make_unique<TorusTest>(false));
  for (int s = 0; s < system.segments(); ++s) tests.push_back(std::make_unique<ImpactVelocityTest>(system, s, false));
  return tests;
}

RecordedBranch continued(const HybridSystem& hybrid, const Signature& signature, const Orbit& start, int principal,
                         double ds, double largest_step, int points) {
  PeriodicOrbits orbits(hybrid, signature, principal, start.shape, {12, 4, 1e-10, 1e-10});
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, principal, ds, largest_step, points);
  settings.location_tolerance = 1e-10;
  settings.max_location = 20;
  return record(orbits.follower, orbits.system, point, settings, all_tests(orbits.system, principal));
}

RecordedBranch normal_form(int field, int jump, double z, double mu, double ds, int points = 12) {
  return continued(system_of<NormalForms>(), {{field, 1, jump}}, NormalForms::orbit(pi, z, mu, 0.0), 1, ds, 0.1,
                   points);
}

/// The one special point is of this type, at mu = 0.
void check_one(const RecordedBranch& branch, PointType type, double tolerance = 1e-8) {
  const auto found = branch.special();
  REQUIRE(found.size() == 1);
  CHECK(found[0]->special.type == type);
  CHECK(std::abs(found[0]->orbit.par(0)) < tolerance);
  CHECK(branch.notes.empty());
}

RecordedBranch impacting(const CutOrbit& cut, const OscillatorOrbit& orbit, double ds, double largest_step,
                         int points) {
  return continued(linosc(), cut.signature, sampled_orbit(cut.pieces, 4, 60, 4, orbit.par()), 1, ds, largest_step,
                   points);
}

/// Largest |second difference| over the range: a pole or a jump makes it of the order of the range.
double roughness(const std::vector<double>& v) {
  const auto [low, high] = std::minmax_element(v.begin(), v.end());
  double worst = 0.0;
  for (std::size_t i = 2; i < v.size(); ++i) worst = std::max(worst, std::abs(v[i] - 2 * v[i - 1] + v[i - 2]));
  return worst / (*high - *low);
}

}  // namespace

TEST_CASE("fold: the turning point of the normal form, from both sides, and no branch point") {
  for (const double side : {1.0, -1.0}) {
    // Along the branch of sqrt(mu) towards smaller mu.
    const RecordedBranch branch = normal_form(2, 1, side * 0.3, 0.09, -0.02, 30);
    check_one(branch, PointType::fold);
    double sign = 0.0;
    for (const RecordedPoint& p : branch.points) {
      CAPTURE(p.number, p.orbit.par(0));
      // The unit tangent of (mu, z) = (z^2, z), oriented towards larger mu at the start.
      const double z = p.orbit.start(0)[2];
      CHECK(*p.values[fold] == Approx(side * 2 * z / std::sqrt(1 + 4 * z * z)).margin(1e-7));
      REQUIRE(p.values[branch_point]);
      if (sign == 0.0) sign = *p.values[branch_point];
      CHECK(*p.values[branch_point] * sign > 0.0);
    }
    CHECK(branch.points.back().orbit.start(0)[2] * side < 0.0);
  }
}

TEST_CASE("fold: the principal parameter may be a duration") {
  const FoldTest of_duration(62, {1}, ParameterLayout(), 2, false);
  const FoldTest of_second(7, {3, 7}, ParameterLayout(), 2, false);
  const OrbitShape shape{1, 2, 2, 2};
  const Orbit x{shape, uniform_mesh(2), Eigen::MatrixXd::Zero(1, shape.columns()), ParameterVector(ParameterLayout())};
  OrbitVector tangent(shape, 2);
  tangent.durations << 0.25, -0.5;
  tangent.globals << 0.125, 0.75;
  const PeriodicOrbitSystem system(system_of<NormalForms>(), {{1, 1, 1}, {1, 1, 1}}, {1});
  CondensedSystem condensed(system, {3, 2, 2, 2}, {1});
  const FloquetMultipliers multipliers;
  const std::vector<double> transversalities{-1.0, -1.0};
  const TestedPoint point{x, tangent, condensed, multipliers, transversalities, 1.0};
  CHECK(of_duration.value(point) == -0.5);
  CHECK(of_second.value(point) == 0.75);
}

TEST_CASE("branch point: pitchfork and transcritical normal forms, no fold and no period doubling there") {
  for (const int field : {1, 3})
    for (const double ds : {0.03, -0.03}) {
      CAPTURE(field, ds);
      const RecordedBranch branch = normal_form(field, 1, 0.0, ds > 0 ? -0.2 : 0.2, ds);
      check_one(branch, PointType::branch_point);
      // The determinant of the boundary value problem goes like exp(-pi mu) - exp(pi mu). Close to the branch point the
      // distance to a singular problem goes like it, farther away other singular values of a few tenths are smaller.
      const double sign = *branch.points.front().values[branch_point] * branch.points.front().orbit.par(0);
      for (const RecordedPoint& p : branch.points) {
        const double mu = p.orbit.par(0);
        CAPTURE(mu);
        if (p.special.type == PointType::branch_point) continue;
        CHECK(*p.values[branch_point] * mu * sign > 0.0);
        const double size = std::min(std::sinh(pi * std::abs(mu)), 0.3);
        CHECK(std::abs(*p.values[branch_point]) > 0.2 * size);
        CHECK(std::abs(*p.values[branch_point]) < 2.0 * size);
      }
    }
}

TEST_CASE("period doubling: normal form, product of 1 + mu times h_x f") {
  for (const double ds : {0.03, -0.03}) {
    const RecordedBranch branch = normal_form(1, 2, 0.0, ds > 0 ? -0.2 : 0.2, ds);
    check_one(branch, PointType::period_doubling);
    for (const RecordedPoint& p : branch.points) {
      if (p.special.type == PointType::period_doubling) continue;
      // On the unit circle h_x f = -1, with |h_x| = |f| = 1.
      const double expected = -(1 + std::exp(-4 * pi)) * (1 - std::exp(2 * pi * p.orbit.par(0)));
      CHECK(*p.values[doubling] == Approx(expected).margin(1e-7));
      CHECK(*p.values[velocity] == Approx(-1.0).epsilon(1e-7));
    }
  }
}

TEST_CASE("across grazing: no pole, no false fold, branch point, period doubling or torus") {
  for (const bool two : {false, true}) {
    CAPTURE(two);
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.02);
    const RecordedBranch branch = impacting(two ? twice(orbit) : whole(orbit), orbit, -0.002, 0.002, 24);
    REQUIRE(branch.points.back().orbit.end(0)[1] < -0.01);
    // Nothing but the impact velocities, which vanish together where v = 0.
    REQUIRE(branch.special().size() == 1);
    const RecordedPoint& grazing = *branch.special()[0];
    CHECK(grazing.special.type == PointType::user);
    CHECK(grazing.special.kind.kind == UserPointKind::impact_velocity);
    CHECK(grazing.orbit.par(0) == Approx(std::abs(OscillatorConstants{2.0072}.stiffness())).margin(1e-9));
    CHECK(std::abs(grazing.orbit.end(0)[1]) < 1e-8);
    CHECK(branch.notes.empty());
    std::vector<double> values;
    for (const RecordedPoint& p : branch.points) {
      CAPTURE(p.number, p.orbit.end(0)[1]);
      if (&p == &grazing || !p.values[doubling]) continue;
      values.push_back(*p.values[doubling]);
      CHECK(values.back() * values.front() > 0.0);
      CHECK(*p.values[branch_point] * *branch.points.front().values[branch_point] > 0.0);
      CHECK(*p.values[velocity] * p.orbit.end(0)[1] < 0.0);
      // |h_x| = 1 and h_x f = -x2.
      CHECK(*p.values[velocity] == Approx(-p.orbit.end(0)[1]).epsilon(1e-12).margin(1e-14));
    }
    REQUIRE(values.size() > 10);
    CHECK(roughness(values) < 0.05);
  }
}

TEST_CASE("the function of the period doubling has no gap at grazing: its limit in closed form") {
  for (const double omega : {2.0072, grazing_omega, 1.8901})
    for (const bool two : {false, true}) {
      CAPTURE(omega, two);
      const OscillatorOrbit orbit = one_impact_orbit(omega, 0.0);
      const RecordedBranch branch = impacting(two ? twice(orbit) : whole(orbit), orbit, 1e-5, 1e-5, 2);
      // (1 + mu_1) ... h_x f / (|h_x| |f|), for the orbit taken twice with the squares of the multipliers.
      const auto product = [&](double v) {
        std::complex<double> result = 1.0;
        for (const auto& mu : one_impact_multipliers(omega, v)) result *= 1.0 + (two ? mu * mu : mu);
        const double crossing = -v / (omega * std::hypot(omega, 1.0));  // f = (0, -omega^2) with a phase of speed omega
        return (result * (two ? crossing * crossing : crossing)).real();
      };
      const double limit = 2 * product(1e-6) - product(2e-6);
      REQUIRE(branch.points.front().values[doubling]);
      CHECK(std::abs(branch.points.front().orbit.end(0)[1]) < 1e-9);
      CHECK(*branch.points.front().values[doubling] == Approx(limit).epsilon(1e-4));
    }
}

TEST_CASE("period doubling beside grazing: found on the way out of the grazing orbit itself") {
  const double v = root_between([](double u) { return characteristic(grazing_omega, u, -1.0); }, 1e-4, 1e-2);
  const double expected = one_impact_orbit(grazing_omega, v).alpha;
  REQUIRE(expected - 3.0 < 1e-5);
  for (const double ds : {1e-3, 0.02, 0.1}) {
    CAPTURE(ds);
    const OscillatorOrbit orbit = one_impact_orbit(grazing_omega, 0.0);
    const RecordedBranch branch = impacting(whole(orbit), orbit, ds, ds, 6);
    const auto found = branch.of_type(PointType::period_doubling);
    REQUIRE(found.size() == 1);
    CHECK(found[0]->orbit.par(0) == Approx(expected).epsilon(1e-11));
    CHECK(branch.special().size() == 1);
    for (const std::string& note : branch.notes) CHECK(note.starts_with("The run starts at a zero of h_x f"));
  }
}

TEST_CASE("period doubling of the impacting orbit: from both sides, multiplier -1") {
  for (const double v : {0.06, 0.02}) {
    const OscillatorOrbit orbit = one_impact_orbit(2.0072, v);
    const RecordedBranch branch = impacting(whole(orbit), orbit, v > 0.04 ? -0.002 : 0.002, 0.01, 8);
    const auto found = branch.of_type(PointType::period_doubling);
    REQUIRE(found.size() == 1);
    CHECK(found[0]->orbit.par(0) == Approx(doubling_alpha).epsilon(1e-10));
    double nearest = 1.0, other = 1.0;
    for (const auto& mu : found[0]->multipliers.values) {
      nearest = std::min(nearest, std::abs(mu + 1.0));
      other = std::min(other, std::abs(mu + 0.467984805));
    }
    CHECK(nearest < 1e-6);
    CHECK(other < 1e-6);
  }
}

TEST_CASE("torus: Langford's system, value and place in closed form") {
  const LangfordCircle exact = LangfordCircle{}.at_torus();
  for (const double direction : {1.0, -1.0}) {
    LangfordCircle from = exact;
    from.a -= 0.1 * direction;
    const RecordedBranch branch =
        continued(system_of<Langford>(), {{1, 1, 1}}, from.orbit(30, 4), 1, 0.03 * direction, 0.05, 8);
    REQUIRE(branch.special().size() == 1);
    CHECK(branch.special()[0]->special.type == PointType::torus);
    CHECK(branch.special()[0]->orbit.par(0) == Approx(exact.a).margin(1e-9));
    for (const RecordedPoint& p : branch.points) {
      LangfordCircle here = exact;
      here.a = p.orbit.par(0);
      REQUIRE(p.values[torus]);
      CHECK(*p.values[torus] == Approx(std::abs(here.multiplier()) - 1).margin(1e-8));
    }
  }
}

TEST_CASE("period doubling and torus are not looked for with untrusted multipliers") {
  FloquetMultipliers multipliers{{{0.3, 0.9}, {0.3, -0.9}, {0.0, 0.0}}, false, 0, 0.01, true};
  const std::vector<double> transversalities{-0.5};
  const PeriodicOrbitSystem system(system_of<NormalForms>(), {{1, 1, 1}}, {1});
  CondensedSystem condensed(system, {3, 1, 2, 2}, {1});
  const Orbit x{};
  const OrbitVector tangent;
  const TestedPoint point{x, tangent, condensed, multipliers, transversalities, 1.0};
  multipliers.with_minus_one.value = -0.5 * (1.3 * 1.3 + 0.81);
  CHECK(*PeriodDoublingTest(false).value(point) == multipliers.with_minus_one.value);
  CHECK(*TorusTest(false).value(point) == Approx(std::sqrt(0.9) - 1));
  multipliers.structural = 0.06;
  CHECK_FALSE(PeriodDoublingTest(false).value(point));
  CHECK_FALSE(TorusTest(false).value(point));
  multipliers = {{}, false, 0, 0.0, false};
  CHECK_FALSE(PeriodDoublingTest(false).value(point));
  CHECK_FALSE(TorusTest(false).value(point));
}

TEST_CASE("torus: a pair that crosses is seen beside another one that stays outside, nearer to the circle") {
  const std::vector<double> transversalities{-0.5};
  const PeriodicOrbitSystem system(system_of<NormalForms>(), {{1, 1, 1}}, {1});
  CondensedSystem condensed(system, {3, 1, 2, 2}, {1});
  const Orbit x{};
  const OrbitVector tangent;
  const auto value = [&](double crossing, double outside) {
    const auto a = std::polar(crossing, 1.0), b = std::polar(outside, 2.0);
    const FloquetMultipliers multipliers{{a, std::conj(a), b, std::conj(b), 0.0}, false, 0, 0.0, true};
    return *TorusTest(false).value({x, tangent, condensed, multipliers, transversalities, 1.0});
  };
  CHECK(value(0.9, 1.05) * value(1.02, 1.05) < 0.0);
  CHECK(value(0.98, 1.05) * value(1.02, 1.05) < 0.0);
  CHECK(std::abs(value(1.0, 1.05)) < 1e-15);
}

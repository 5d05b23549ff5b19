// One orbit entered in several ways: repeated, cut, with a segment of no duration, rotated.
#include <catch2/catch.hpp>

#include "support/branch_fixture.hpp"
#include "support/linear_oscillator.hpp"
#include "support/multiplier_sets.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

struct Corrected {
  Orbit orbit;
  Multipliers multipliers;
  Multipliers nontrivial;  // without the structural zero
  std::vector<Violation> violations;
};

Corrected corrected(const Signature& signature, const std::vector<Piece>& pieces, const ParameterVector& par,
                    int intervals = 50) {
  const Orbit start = sampled_orbit(pieces, 4, intervals, 4, par);
  PeriodicOrbits orbits(linosc(), signature, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  const FloquetMultipliers multipliers = orbits.multipliers(point);
  REQUIRE(multipliers.valid);
  return {point.orbit, multipliers.values, nontrivial(multipliers.values, multipliers.structural),
          inadmissibilities(linosc(), signature, std::vector<std::vector<int>>(signature.size(), {1}), point.orbit,
                            CollocationRule(4), 0.0)};
}

struct Place {
  double omega, v;
};

/// A complex pair, real multipliers of both signs and all sizes.
const std::vector<Place> places{{2.0072, 0.5}, {2.0072, 0.01}, {2.0072, 5.0}, {1.8901, 1.0}, {1.8901, 8.0}};

/// The first time after 0 at which x2 rises through zero: the minimum of x1.
double time_of_minimum(const OscillatorOrbit& orbit) {
  double low = 1e-6, high = low;
  while (orbit.state(high)(1) < 0.0) high += 1e-3;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (orbit.state(middle)(1) < 0.0 ? low : high) = middle;
  }
  return high;
}

Multipliers powers(Multipliers values, int exponent) {
  for (std::complex<double>& mu : values) mu = std::pow(mu, exponent);
  return values;
}

}  // namespace

TEST_CASE("an orbit repeated 2, 4, 8 times: the same states, the powers of each multiplier") {
  const int m = GENERATE(2, 4, 8);
  for (const Place& place : places) {
    CAPTURE(m, place.omega, place.v);
    const OscillatorOrbit orbit = one_impact_orbit(place.omega, place.v);
    const Piece piece = orbit.piece(0, orbit.constants.period());
    const Corrected once = corrected({{1, 1, 1}}, {piece}, orbit.par());
    const Corrected repeated = corrected(Signature(static_cast<std::size_t>(m), {1, 1, 1}),
                                         std::vector<Piece>(static_cast<std::size_t>(m), piece), orbit.par());
    for (int s = 0; s < m; ++s) {
      const auto states = repeated.orbit.states.middleCols(s * once.orbit.shape.nodes(), once.orbit.shape.nodes());
      CHECK((states - once.orbit.states).cwiseAbs().maxCoeff() < 1e-9);
      CHECK(std::abs(repeated.orbit.duration(s) - once.orbit.duration(0)) < 1e-9);
    }
    // Nonzero multipliers reach from (8e0)^8 to (2e-3)^8 = 2e-22 here: each to 1e-6 of its own size.
    CHECK(relative_distance(repeated.nontrivial, powers(once.nontrivial, m)) < 1e-6);
    CHECK(repeated.multipliers.size() == 4);
  }
}

TEST_CASE("an orbit cut at an identity event keeps its multipliers") {
  for (const Place& place : places) {
    CAPTURE(place.omega, place.v);
    const OscillatorOrbit orbit = one_impact_orbit(place.omega, place.v);
    const double period = orbit.constants.period(), cut = time_of_minimum(orbit);
    const Corrected whole = corrected({{1, 1, 1}}, {orbit.piece(0, period)}, orbit.par());
    const Corrected pieces =
        corrected({{1, 3, 2}, {1, 1, 1}}, {orbit.piece(0, cut), orbit.piece(cut, period)}, orbit.par());
    CHECK(std::abs(pieces.orbit.duration(0) - cut) < 1e-9);
    CHECK((pieces.orbit.states.col(0) - whole.orbit.states.col(0)).cwiseAbs().maxCoeff() < 1e-9);
    // Both are discretised to 1e-10; the factor 8 of the large multiplier at v = 0.01 is in the relative measure.
    CHECK(mixed_distance(pieces.multipliers, whole.multipliers) < 1e-8);
    CHECK(pieces.violations.empty());
  }
}

TEST_CASE("segments rotated cyclically: the same orbit and multipliers") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const double period = orbit.constants.period(), cut = time_of_minimum(orbit);
  const Piece first = orbit.piece(0, cut), second = orbit.piece(cut, period);
  const Corrected a = corrected({{1, 3, 2}, {1, 1, 1}}, {first, second}, orbit.par());
  const Corrected b = corrected({{1, 1, 1}, {1, 3, 2}}, {second, first}, orbit.par());
  const Eigen::Index nodes = a.orbit.shape.nodes();
  CHECK((a.orbit.states.leftCols(nodes) - b.orbit.states.rightCols(nodes)).cwiseAbs().maxCoeff() < 1e-11);
  CHECK(mixed_distance(a.multipliers, b.multipliers) < 1e-10);
}

TEST_CASE("a segment of zero duration before the impact changes nothing else") {
  for (const Place& place : places) {
    CAPTURE(place.omega, place.v);
    const OscillatorOrbit orbit = one_impact_orbit(place.omega, place.v);
    const double period = orbit.constants.period();
    const Corrected without = corrected({{1, 1, 1}}, {orbit.piece(0, period)}, orbit.par());
    // Segment 1 reaches the wall with the identity, segment 2 has been there all along: h1 = 0 fixes T_2 = 0.
    const Corrected with =
        corrected({{1, 1, 2}, {1, 1, 1}}, {orbit.piece(0, period), orbit.piece(period, period)}, orbit.par());
    CHECK(std::abs(with.orbit.duration(1)) < 1e-9);
    const Eigen::Index nodes = without.orbit.shape.nodes();
    CHECK((with.orbit.states.leftCols(nodes) - without.orbit.states).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(mixed_distance(with.multipliers, without.multipliers) < 1e-7);
    CHECK(with.violations.empty());
  }
}

TEST_CASE("a segment of zero duration stays one along the branch") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 0.5);
  const double period = orbit.constants.period();
  const Orbit start = sampled_orbit({orbit.piece(0, period), orbit.piece(period, period)}, 4, 50, 4, orbit.par());
  PeriodicOrbits orbits(linosc(), {{1, 1, 2}, {1, 1, 1}}, 1, start.shape);
  const PathPoint point = orbits.corrected(start);
  REQUIRE(orbits.result.converged());
  ContinuationSettings settings = branch_settings(start.shape, 1, 0.02, 0.5, 20);
  settings.adapt_mesh_every = 2;
  settings.monitored = {{1}, {1}};
  KeepingSink sink;
  ContinuationRun run(orbits.follower, orbits.system, settings, {}, sink);
  run.run(point);
  REQUIRE(sink.points.size() == 20);
  for (const KeptPoint& p : sink.points) {
    const double v = p.orbit.end(1)[1];
    CAPTURE(p.number, v);
    CHECK(std::abs(p.orbit.duration(1)) < 1e-9);
    CHECK(std::abs(p.orbit.par(0) - one_impact_orbit(2.0072, v).alpha) < 1e-9);
    CHECK(mixed_distance(p.multipliers.values, one_impact_multipliers(2.0072, v)) < 1e-7);
    CHECK(p.violations.empty());
  }
}

// Norms, maxima and means over the whole period.
#include <catch2/catch.hpp>
#include <cmath>

#include "continuation/solution_measure.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;

namespace {

const CollocationRule rule(4);
const Eigen::Vector4d ones = Eigen::Vector4d::Ones();

Orbit orbit_cut_at(const std::vector<double>& times) {
  const OscillatorOrbit orbit = nonimpacting_orbit(2.0, 3.0);
  std::vector<Piece> pieces;
  for (std::size_t k = 1; k < times.size(); ++k) pieces.push_back(orbit.piece(times[k - 1], times[k]));
  return sampled_orbit(pieces, 4, 40, 4, orbit.par());
}

}  // namespace

TEST_CASE("measures of the nonimpacting orbit in closed form") {
  const Orbit x = orbit_cut_at({0.0, pi});
  const double amplitude = 3.0 / std::abs(OscillatorConstants{2.0}.stiffness());
  // Means of squares: amplitude^2 / 2, (2 amplitude)^2 / 2, 1 / 2, 1 / 2. The interpolation error is 1e-8.
  CHECK(l2_norm(x, rule, ones) == Approx(std::sqrt(2.5 * amplitude * amplitude + 1.0)).epsilon(1e-7));
  CHECK(l2_norm(x, rule, Eigen::Vector4d(0, 3, 0, 0)) == Approx(std::sqrt(6.0) * amplitude).epsilon(1e-7));
  CHECK(maximum_of(x, 1) == Approx(amplitude).epsilon(1e-12));
  CHECK(minimum_of(x, 1) == Approx(-amplitude).epsilon(1e-3));
  CHECK(solution_measure(x, rule, ones, 0) == l2_norm(x, rule, ones));
  CHECK(solution_measure(x, rule, ones, 13) == l2_norm(x, rule, ones));
  CHECK(solution_measure(x, rule, ones, -5) == l2_norm(x, rule, ones));
  CHECK(solution_measure(x, rule, ones, 1) == maximum_of(x, 1));
  CHECK(solution_measure(x, rule, ones, -2) == minimum_of(x, 2));
  CHECK(std::abs(solution_measure(x, rule, ones, 5)) < 1e-8);
  CHECK(solution_measure(x, rule, ones, 9) == Approx(amplitude / std::sqrt(2.0)).epsilon(1e-7));
  CHECK(solution_measure(x, rule, ones, 12) == Approx(std::sqrt(0.5)).epsilon(1e-7));
}

TEST_CASE("cutting an orbit does not change its measures") {
  const Orbit whole = orbit_cut_at({0.0, pi});
  for (const std::vector<double>& cuts :
       {std::vector<double>{0.0, 1.0, pi}, {0.0, 0.1, 0.1, 2.0, pi}, {0.0, pi, pi}, {0.0, pi, 2 * pi}}) {
    const Orbit cut = orbit_cut_at(cuts);
    for (const int measure : {0, 5, 6, 7, 8, 9, 10, 11, 12}) {
      CAPTURE(cuts.size(), measure);
      CHECK(solution_measure(cut, rule, ones, measure) ==
            Approx(solution_measure(whole, rule, ones, measure)).margin(1e-7));
    }
    CHECK(maximum_of(cut, 1) == Approx(maximum_of(whole, 1)).epsilon(1e-12));
  }
}

TEST_CASE("all durations zero: a plain mean, no division by zero") {
  const Orbit x = orbit_cut_at({0.0, 0.0, 0.0});
  const double expected = Eigen::Map<const Eigen::Vector4d>(x.start(0)).norm();
  CHECK(l2_norm(x, rule, ones) == Approx(expected));
}

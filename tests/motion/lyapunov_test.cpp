// Lyapunov exponents along simulations: closed forms, published values, honest bars.
#include <catch2/catch.hpp>
#include <cmath>

#include "base/messages.hpp"
#include "lyapunov_problems.hpp"
#include "motion/chaos_evidence.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;
using Eigen::VectorXd;

namespace {

/// ln |mu| / period, descending; minus infinity for 0.
std::vector<double> logarithms(const std::vector<std::complex<double>>& multipliers, double period) {
  std::vector<double> exponents;
  for (const auto& mu : multipliers) exponents.push_back(mu == 0.0 ? -INFINITY : std::log(std::abs(mu)) / period);
  std::sort(exponents.rbegin(), exponents.rend());
  return exponents;
}

/// One-impact orbit of the linear oscillator that attracts: events are impacts alone.
struct ImpactingOrbit {
  double omega = 2.0072, velocity = 1.0;
  OscillatorOrbit orbit = one_impact_orbit(omega, velocity);
  ModeRule rule{linosc(), std::vector<Mode>{Mode{{IndexVector{1, 1, 1}}, {}}}};
};

void check_orbit_exponents(const LyapunovSpectrum& s, const std::vector<double>& expected, double tolerance = 1e-6) {
  REQUIRE(static_cast<std::size_t>(s.exponents.size()) == expected.size());
  for (std::size_t j = 0; j < expected.size(); ++j) {
    CAPTURE(j, s.exponents.transpose(), s.errors.transpose(), expected);
    const double error = std::abs(s.exponents(static_cast<Eigen::Index>(j)) - expected[j]);
    CHECK(error < tolerance);
    CHECK(error <= 2.0 * s.errors(static_cast<Eigen::Index>(j)));
    CHECK(s.errors(static_cast<Eigen::Index>(j)) < 1e-4);
  }
}

TEST_CASE("growth like a power of time is no chaos, at however many error bars") {
  // Windows of 64, 128, ... events: exp(0.1 t) has the same exponent in each, t^2 half of that of the window before.
  const auto judged = [](double second_share) {
    ChaosJudge judge;
    double rate = 0.1, length = 64.0;
    for (int window = 0; window < 5; ++window, length *= 2.0, rate *= second_share) {
      LyapunovSpectrum spectrum;
      spectrum.exponents = Eigen::Vector2d(rate, 0.0);
      spectrum.errors = Eigen::Vector2d(1e-3 * rate, 1e-9);
      spectrum.structural = {1};
      spectrum.time = length;
      spectrum.events = static_cast<long>(length);
      judge.add(spectrum, Eigen::Vector2d(1.0, 1.0));
    }
    return judge.is_chaotic();
  };
  CHECK(judged(1.0));
  CHECK(judged(0.9));
  CHECK_FALSE(judged(0.5));
  CHECK_FALSE(judged(0.6));  // as ln(s t) / t does
}

}  // namespace

TEST_CASE("exponents of an impacting orbit in closed form", "[slow]") {
  const ImpactingOrbit known;
  const double period = known.orbit.constants.period();
  std::vector<double> expected = logarithms(one_impact_multipliers(known.omega, known.velocity), period);
  expected.back() = 0.0;  // along the flow, in place of the 0 of the return map
  std::sort(expected.rbegin(), expected.rend());

  const VectorXd start = known.orbit.state(0.0);
  const Measured along = measure(known.rule, start, known.orbit.par(), 30, 1500);
  REQUIRE(along.last.ended_by == SegmentEnd::event);
  check_orbit_exponents(along.spectrum, expected);
  CHECK(along.spectrum.events == 1500);
  CHECK(along.spectrum.time == Approx(1500 * period).epsilon(1e-9));

  const Measured again = measure(known.rule, start, known.orbit.par(), 30, 300, {}, false);
  LyapunovSettings two;
  two.exponents = 2;
  const Measured largest = measure(known.rule, start, known.orbit.par(), 30, 300, two);
  REQUIRE(largest.spectrum.exponents.size() == 2);
  CHECK((again.spectrum.exponents.head(2) - largest.spectrum.exponents).norm() < 1e-8);
}

TEST_CASE("exponents of return maps: of the wall, and of a minimum that ends no segment", "[slow]") {
  const ImpactingOrbit known;
  std::vector<double> expected = logarithms(one_impact_multipliers(known.omega, known.velocity), 1.0);
  expected.pop_back();
  for (const int section : {1, 3}) {
    CAPTURE(section);
    LyapunovSettings settings;
    settings.section = section;
    check_orbit_exponents(measure(known.rule, known.orbit.state(0.0), known.orbit.par(), 30, 1500, settings).spectrum,
                          expected, 5e-6);  // per turn of length 3: 1.6e-6 per unit of time
  }
}

TEST_CASE("exponents of a chaotic hybrid motion in closed form: the logistic map once per unit of time") {
  // a = 4: ln 2 per unit of time, and 0 along the flow and of the state that grows for ever.
  const Measured m =
      measure(always<LogisticClock>({{1, 1, 1}}), Eigen::Vector3d(0.0, 0.1234, 0.0), parameters({4.0}), 50, 4000);
  const LyapunovSpectrum& s = m.spectrum;
  CHECK(std::abs(s.exponents(0) - std::log(2.0)) <= 2.0 * s.errors(0));
  CHECK(s.errors(0) < 0.02);
  CHECK(std::abs(s.exponents(1)) <= 3.0 * s.errors(1));
  CHECK(std::abs(s.exponents(2)) <= 3.0 * s.errors(2));
}

TEST_CASE("bars are honest: of 40 chaotic hybrid runs at least 36 within two bars", "[slow]") {
  double long_run = 0.0, x = 0.2345;
  constexpr int iterates = 5000000;
  for (int i = 0; i < iterates; ++i, x = 3.8 * x * (1.0 - x)) long_run += std::log(std::abs(3.8 * (1.0 - 2.0 * x)));
  long_run /= iterates;
  int within = 0;
  for (int run = 0; run < 40; ++run) {
    LyapunovSettings one;
    one.exponents = 1;
    const Measured m = measure(always<LogisticClock>({{1, 1, 1}}), Eigen::Vector3d(0.0, 0.1 + 0.0137 * run, 0.0),
                               parameters({3.8}), 50, 500, one, true, settings_for_tests(1e-6));
    within += std::abs(m.spectrum.exponents(0) - long_run) <= 2.0 * m.spectrum.errors(0) ? 1 : 0;
    CHECK(m.spectrum.errors(0) < 0.1);
  }
  CHECK(within >= 36);
}

TEST_CASE("Lorenz: the published exponents, and their sum", "[slow]") {
  // 0.9056, 0, -14.5723 (Sprott, Chaos and Time-Series Analysis, 2003); the divergence is -(10 + 1 + 8 / 3).
  const Measured m = measure(always<Lorenz>({{1, 1, 1}}), Eigen::Vector3d(1.0, 2.0, 20.0), lorenz_parameters(), 50,
                             1500, {}, true, settings_for_tests(1e-9));
  const LyapunovSpectrum& s = m.spectrum;
  CAPTURE(s.exponents.transpose(), s.errors.transpose());
  CHECK(std::abs(s.exponents(0) - 0.9056) <= 2.0 * s.errors(0));
  CHECK(std::abs(s.exponents(1)) <= 3.0 * s.errors(1));
  CHECK(std::abs(s.exponents(2) + 14.5723) <= 2.0 * s.errors(2));
  CHECK(s.errors(0) < 0.03);
  CHECK(std::abs(s.exponents.sum() + 10.0 + 1.0 + 8.0 / 3.0) < 0.01);
}

TEST_CASE("Lorenz without events: one long segment does not overflow") {
  SimulationSettings settings = settings_for_tests(1e-9);
  settings.flow.max_steps = 1000000;
  const HybridSystem& system = system_of<Lorenz>();
  const ParameterVector par = lorenz_parameters();
  LyapunovSettings wanted;
  wanted.flow = settings.flow;
  LyapunovAccumulator exponents(system, par, wanted);
  SimulatedSegment segment;
  segment.mode = Mode{{IndexVector{1, 1, 1}}, {}};
  segment.start = segment.end = Eigen::Vector3d(-3.1, -5.2, 17.0);
  segment.duration = 300.0;
  segment.ended_by = SegmentEnd::end_time;
  exponents.pass(segment);
  const LyapunovSpectrum s = exponents.spectrum();
  CAPTURE(s.exponents.transpose(), s.errors.transpose());
  CHECK(std::abs(s.exponents(0) - 0.9056) <= 3.0 * s.errors(0));
  CHECK(s.errors(0) < 0.06);
  CHECK(std::abs(s.exponents.sum() + 10.0 + 1.0 + 8.0 / 3.0) < 0.05);
  CHECK(s.events == 0);
}

TEST_CASE("an equilibrium without events: real parts of eigenvalues, however large") {
  SimulationSettings settings = settings_for_tests(1e-10);
  const Measured m = measure(always<Diagonal>({{1, 1, 1}}), Eigen::Vector3d(0.0, 0.0, 0.0),
                             parameters({50.0, -1.0, -2000.0}), 0, 1, {}, true, settings, 100.0);
  CHECK(m.last.ended_by == SegmentEnd::end_time);
  CHECK(m.spectrum.exponents(0) == Approx(50.0).epsilon(1e-8));
  CHECK(m.spectrum.exponents(1) == Approx(-1.0).epsilon(1e-6));
  CHECK(m.spectrum.exponents(2) == Approx(-2000.0).epsilon(1e-8));
}

TEST_CASE("a torus: two zeros", "[slow]") {
  const Measured m = measure(always<TwoCircles>({{1, 1, 1}}), Eigen::Vector4d(1.0, 0.1, 0.6, 0.8),
                             parameters({1.0, 0.5 * (std::sqrt(5.0) - 1.0)}), 10, 700);
  check_orbit_exponents(m.spectrum, {0.0, 0.0, -2.0, -2.0});
}

TEST_CASE("where sticking begins a direction is lost") {
  const Measured m = measure(ModeRule(system_of<Belt>()), Eigen::Vector2d(-1.0, 0.0), parameters({0.5, 0.0}), 2, 400);
  REQUIRE(m.last.ended_by == SegmentEnd::event);
  CHECK(std::abs(m.spectrum.exponents(0)) < 1e-6);
  CHECK(m.spectrum.exponents(1) == -INFINITY);
  CHECK(m.spectrum.tangential == 0);
}

TEST_CASE("exponents: what cannot be is said") {
  const ParameterVector par = lorenz_parameters();
  const auto make = [&](int exponents, int section) {
    LyapunovSettings settings;
    settings.exponents = exponents;
    settings.section = section;
    LyapunovAccumulator accumulator(system_of<Lorenz>(), par, settings);
  };
  CHECK_THROWS_WITH(make(4, 0), Contains("4 Lyapunov exponents") && Contains("has 3"));
  CHECK_THROWS_WITH(make(3, 1), Contains("has 2 on a section"));
  CHECK_THROWS_WITH(make(0, 2), Contains("event functions 1 to 1"));
  CHECK_NOTHROW(make(2, 1));
}

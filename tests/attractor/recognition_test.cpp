// What a simulation has settled on.
#include <catch2/catch.hpp>
#include <cmath>

#include "attractor/attractor_recognition.hpp"
#include "lyapunov_problems.hpp"
#include "support/linear_oscillator.hpp"
#include "text/user_error.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::VectorXd;

namespace {

RecognitionSettings so_many(long transient, long events) {
  RecognitionSettings settings;
  settings.plan.transient_events = transient;
  settings.plan.events = events;
  return settings;
}

Attractor recognise(const ModeRule& rule, const VectorXd& x0, const ParameterVector& par,
                    const RecognitionSettings& settings) {
  SimulationSettings simulation = settings_for_tests(1e-10);
  simulation.samples = 0;
  return recognise_attractor(rule, x0, par, simulation, settings);
}

}  // namespace

TEST_CASE("recognised: a periodic orbit, with signature, period and exponents on request") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 1.0);
  const ModeRule rule(linosc(), std::vector<Mode>{Mode{{IndexVector{1, 1, 1}, IndexVector{1, 2, 2}}, {}}});
  RecognitionSettings settings = so_many(200, 64);
  const Attractor plain = recognise(rule, orbit.state(0.1), orbit.par(), settings);
  CHECK(plain.kind == AttractorKind::periodic);
  CHECK(plain.signature == Signature{{1, 1, 1}});
  CHECK(plain.period == Approx(orbit.constants.period()).epsilon(1e-7));
  CHECK_FALSE(plain.spectrum.has_value());
  CHECK(plain.events == 264);
  CHECK((plain.state - plain.last.after).norm() < 1e-5);

  settings.exponents = RecognitionSettings::Exponents::always;
  const Attractor with = recognise(rule, orbit.state(0.1), orbit.par(), settings);
  REQUIRE(with.spectrum.has_value());
  CHECK(std::abs(with.spectrum->exponents(0)) <= 3.0 * with.spectrum->errors(0));
  CHECK(with.spectrum->events == 64);
}

TEST_CASE("recognised: chaotic, of a long period, quasi-periodic, not told") {
  const ModeRule logistic = always<LogisticClock>({{1, 1, 1}});
  const Eigen::Vector3d start(0.0, 0.1234, 0.0);
  const Attractor chaotic = recognise(logistic, start, parameters({4.0}), so_many(50, 100));
  CHECK(chaotic.kind == AttractorKind::chaotic);
  REQUIRE(chaotic.spectrum.has_value());
  CHECK(chaotic.spectrum->exponents(0) > 0.5);
  CHECK(std::isnan(chaotic.period));
  CHECK(chaotic.signature.empty());

  RecognitionSettings never = so_many(50, 100);
  never.exponents = RecognitionSettings::Exponents::never;
  CHECK(recognise(logistic, start, parameters({4.0}), never).kind == AttractorKind::none);

  // a = 3.55 has the period 8.
  RecognitionSettings up_to_four = so_many(3000, 100);
  up_to_four.plan.max_period = 8;
  CHECK(recognise(logistic, start, parameters({3.55}), up_to_four).signature.size() == 8);

  const ModeRule circles = always<TwoCircles>({{1, 1, 1}});
  const ParameterVector golden = parameters({1.0, 0.5 * (std::sqrt(5.0) - 1.0)});
  const Attractor torus = recognise(circles, Eigen::Vector4d(1.0, 0.1, 0.6, 0.8), golden, so_many(20, 128));
  CAPTURE(torus.reason);
  CHECK(torus.kind == AttractorKind::quasi_periodic);
}

TEST_CASE("recognised: with a time instead of events") {
  RecognitionSettings settings;
  settings.plan.transient_time = 50.0;
  settings.plan.time = 150.0;
  const Attractor a =
      recognise(always<LogisticClock>({{1, 1, 1}}), Eigen::Vector3d(0.0, 0.1234, 0.0), parameters({4.0}), settings);
  CHECK(a.kind == AttractorKind::chaotic);
  CHECK(a.time == Approx(200.0).margin(1.0));
}

TEST_CASE("recognised: chattering, rest, escape, no event") {
  const ModeRule ball = always<BouncingBall>({{1, 1, 1}});
  const Attractor chatters = recognise(ball, Eigen::Vector2d(1.0, 0.0), parameters({1.0, 0.5}), so_many(0, 1000));
  CHECK(chatters.kind == AttractorKind::chattering);
  CHECK_FALSE(chatters.reason.empty());

  const Attractor bounces = recognise(ball, Eigen::Vector2d(1.0, 0.0), parameters({1.0, 1.2}), so_many(0, 1000));
  CHECK(bounces.kind == AttractorKind::escape);

  const ModeRule diagonal = always<Diagonal>({{1, 1, 1}});
  const Eigen::Vector3d start(1.0, 1.0, 1.0);
  CHECK(recognise(diagonal, start, parameters({-1.0, -1.0, -1.0}), so_many(0, 10)).kind == AttractorKind::rest);
  const Attractor grows = recognise(diagonal, start, parameters({1.0, -1.0, -1.0}), so_many(0, 10));
  CHECK(grows.kind == AttractorKind::escape);
  CHECK(grows.reason.find("exceeds") != std::string::npos);
  CHECK(grows.time < 15.0);  // e^13.8 = 1e6
}

TEST_CASE("recognised: the signs of exponents") {
  LyapunovSpectrum s;
  s.time = 100.0;
  s.events = 100;
  const auto kind = [&](std::initializer_list<double> exponents, std::initializer_list<double> errors) {
    s.exponents = Eigen::Map<const VectorXd>(exponents.begin(), static_cast<Eigen::Index>(exponents.size()));
    s.errors = Eigen::Map<const VectorXd>(errors.begin(), static_cast<Eigen::Index>(errors.size()));
    return kind_by_exponents(s);
  };
  CHECK(kind({0.1, 0.0, -1.0}, {0.01, 0.01, 0.01}) == AttractorKind::chaotic);
  CHECK(kind({0.002, 0.0, -1.0}, {0.001, 0.001, 0.01}) == AttractorKind::quasi_periodic);
  CHECK(kind({0.02, 0.0, -1.0}, {0.01, 0.001, 0.01}) == AttractorKind::none);  // a torus, or weak chaos
  CHECK(kind({0.02, 0.0, -1.0}, {0.1, 0.01, 0.01}) == AttractorKind::none);
  CHECK(kind({0.0, -0.5, -INFINITY}, {0.001, 0.01, 0.0}) == AttractorKind::periodic);
  CHECK(kind({-0.1, -0.5, -1.0}, {0.01, 0.01, 0.0}) == AttractorKind::rest);
  CHECK(kind({0.0}, {0.01}) == AttractorKind::none);  // one exponent does not tell
  CHECK(kind({0.0, NAN}, {0.01, INFINITY}) == AttractorKind::none);
}

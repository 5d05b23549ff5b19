// Values of a sweep by simulation whose attractors are known: the impact oscillator and the logistic map.
#include "simulate/simulation_sampler.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "motion/simulated_problems.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::VectorXd;

namespace {

SamplerSetup setup_from(const VectorXd& start, const ParameterVector& par, const std::string& modes) {
  SamplerSetup setup;
  setup.request.modes = modes;
  setup.request.tolerance = 1e-9;
  setup.request.plan.transient_events = 1000;
  setup.request.plan.events = 100;
  setup.starts = {start};
  setup.sides = {StartSide{}};
  setup.par = par;
  setup.recording.states = Recording::States::all_events;
  return setup;
}

SweepTarget parameter(const std::string& name, int position) {
  return {SweptQuantity{name, 0.0, 4.0, 5, false}, position};
}

AttractorSample sampled(const SamplerSetup& setup, const HybridSystem& system, const VectorXd& values) {
  return SimulationSampler(setup, system)({0, values, 1, {}}, [] { return false; });
}

}  // namespace

TEST_CASE("swept values are written into the state and PAR, and a state of its own has no side") {
  SamplerSetup setup = setup_from(Eigen::Vector2d(1.0, 2.0), parameters({3.0, 4.0}), "1,1,1");
  setup.over = {parameter("r", 2), {SweptQuantity{"x1", 0.0, 1.0, 2, true}, 1}};
  setup.sides = {StartSide{StartSide::Given::after, 1}};
  const SampleStart start = sample_start(setup, {0, Eigen::Vector2d(0.5, 7.0), 1, {}});
  CHECK(start.state == Eigen::Vector2d(7.0, 2.0));
  CHECK(start.par(0) == 3.0);
  CHECK(start.par(1) == 0.5);
  CHECK(start.side.given == StartSide::Given::nothing);
  // Where a neighbour's final state is gone on from, it is the start.
  const SampleStart further =
      sample_start(setup, {0, Eigen::Vector2d(0.5, 7.0), 1, MotionState{VectorXd::Ones(2), {}}});
  CHECK(further.state == VectorXd::Ones(2));
  CHECK(further.par(1) == 0.5);
}

TEST_CASE("impact oscillator: the orbit with one impact a period, its impact velocity and period") {
  const double velocity = 1.0;
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, velocity);
  SamplerSetup setup = setup_from(orbit.state(0.1), orbit.par(), "1,1,1;1,2,2");
  setup.over = {parameter("alpha", 1)};
  const AttractorSample sample = sampled(setup, linosc(), VectorXd::Constant(1, orbit.alpha));
  CHECK(sample.kind == AttractorKind::periodic);
  CHECK(sample.period == Approx(orbit.constants.period()).epsilon(1e-7));
  CHECK(sample.impacts == 1);
  REQUIRE(sample.sections.cols() == 1);
  CHECK(sample.sections(0, 0) == Approx(1.0).epsilon(1e-8));
  CHECK(sample.sections(1, 0) == Approx(velocity).epsilon(1e-6));
  CHECK(sample.section_events == std::vector<int>{1});
}

TEST_CASE("impact oscillator without impacts: the largest values are its amplitudes") {
  const double omega = 2.0072, zeta = 0.05, alpha = 2.0;
  SamplerSetup setup =
      setup_from(Eigen::Vector4d(0.0, 0.0, 0.0, 1.0), parameters({alpha, omega, zeta, 0.8}), "1,1,1;1,2,2");
  setup.recording.largest = true;
  const AttractorSample sample = sampled(setup, linosc(), VectorXd());
  REQUIRE(sample.kind == AttractorKind::periodic);
  REQUIRE(sample.impacts == 0);
  const double amplitude = alpha / std::hypot(1.0 - omega * omega, 2.0 * zeta * omega);
  REQUIRE(sample.largest.cols() == sample.sections.cols());
  for (Eigen::Index k = 0; k < sample.largest.cols(); ++k) {
    CHECK(sample.largest(0, k) == Approx(amplitude).epsilon(1e-7));
    CHECK(sample.largest(1, k) == Approx(amplitude * omega).epsilon(1e-7));
    CHECK(sample.largest(2, k) == Approx(1.0).epsilon(1e-7));
  }
}

TEST_CASE("logistic map of a clock: periods, and chaos with the exponent ln 2") {
  const HybridSystem& system = system_of<LogisticClock>();
  SamplerSetup setup = setup_from(Eigen::Vector3d(0.0, 0.3, 0.0), parameters({0.0}), "1,1,1");
  setup.over = {parameter("a", 1)};
  for (const auto& [a, period] : {std::pair(2.8, 1), {3.2, 2}, {3.5, 4}, {3.832, 3}}) {
    CAPTURE(a);
    const AttractorSample sample = sampled(setup, system, VectorXd::Constant(1, a));
    CHECK(sample.kind == AttractorKind::periodic);
    CHECK(static_cast<int>(sample.signature.size()) == period);
    CHECK(sample.period == Approx(period).epsilon(1e-8));
    REQUIRE(sample.sections.cols() == period);
    // The period begins where the state is least, so at the smallest c.
    for (Eigen::Index k = 0; k < period; ++k) {
      const double c = sample.sections(1, k), next = sample.sections(1, (k + 1) % period);
      CHECK(next == Approx(a * c * (1.0 - c)).epsilon(1e-6));
    }
  }
  setup.recording.exponents = 3;
  setup.recording.largest = true;
  const AttractorSample chaos = sampled(setup, system, VectorXd::Constant(1, 4.0));
  CHECK(chaos.kind == AttractorKind::chaotic);
  CHECK(std::isnan(chaos.period));
  REQUIRE(chaos.exponents.size() == 3);
  CHECK(std::abs(chaos.exponents(0) - std::log(2.0)) <= 4.0 * chaos.errors(0));
  // Without a period the largest values are those up to the next event: c is constant in between.
  const Eigen::Index last = chaos.sections.cols() - 1;
  REQUIRE(chaos.largest.cols() == last + 1);
  for (Eigen::Index k = 0; k < last; ++k) CHECK(chaos.largest(1, k) == Approx(chaos.sections(1, k + 1)).epsilon(1e-9));
  CHECK(std::isnan(chaos.largest(0, last)));
}

TEST_CASE("a sampler that is interrupted gives the value up") {
  SamplerSetup setup = setup_from(Eigen::Vector3d(0.0, 0.3, 0.0), parameters({3.7}), "1,1,1");
  const SimulationSampler sampler(setup, system_of<LogisticClock>());
  CHECK_THROWS_AS(sampler({0, VectorXd(), 1, {}}, [] { return true; }), SampleInterrupted);
}

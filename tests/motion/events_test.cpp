// Events of a simulation against closed forms: when, in which state, which comes first.
#include <algorithm>
#include <catch2/catch.hpp>

#include "../model/linear_oscillator.hpp"
#include "simulated_problems.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

/// x'' + 2 zeta x' + x = alpha cos(omega t) of linosc after time t, the phase being on its circle.
VectorXd linear_flow(const VectorXd& x, const VectorXd& par, double t) {
  const double alpha = par(0), omega = par(1), zeta = par(2);
  const double damped = std::sqrt(1.0 - zeta * zeta);
  const double phase = std::atan2(x(2), x(3));
  const std::complex<double> i(0.0, 1.0);
  const std::complex<double> response = alpha / (1.0 - omega * omega + 2.0 * zeta * omega * i);
  const auto forced = [&](double s) { return response * std::exp(i * (omega * s + phase)); };
  const double free0 = x(0) - forced(0.0).real();
  const double free1 = x(1) - (i * omega * forced(0.0)).real();
  const double a = free0, b = (free1 + zeta * free0) / damped;
  const double decay = std::exp(-zeta * t), c = std::cos(damped * t), s = std::sin(damped * t);
  VectorXd y(4);
  y << decay * (a * c + b * s) + forced(t).real(),
      decay * (-zeta * (a * c + b * s) + damped * (b * c - a * s)) + (i * omega * forced(t)).real(),
      std::sin(omega * t + phase), std::cos(omega * t + phase);
  return y;
}

}  // namespace

TEST_CASE("bouncing ball: times and velocities of impacts in closed form") {
  const IntegrationMethod method = GENERATE(IntegrationMethod::adams, IntegrationMethod::runge_kutta);
  const double g = 9.81, r = 0.7, height = 2.0;
  const double first = std::sqrt(2.0 * height / g);
  const Simulated ball = simulate(always<BouncingBall>({{1, 1, 1}}), Vector2d(height, 0.0), parameters({g, r}),
                                  so_many_events(8), settings_for_tests(1e-12, method));
  REQUIRE(ball.segments.size() == 8);
  double time = first, velocity = g * first;
  for (const SimulatedSegment& segment : ball.segments) {
    CAPTURE(segment.number);
    CHECK(segment.ended_by == SegmentEnd::event);
    CHECK(segment.index == IndexVector{1, 1, 1});
    CHECK(segment.end_time() == Approx(time).epsilon(1e-11));
    CHECK(std::abs(segment.end(0)) < 1e-13);
    CHECK(segment.end(1) == Approx(-velocity).epsilon(1e-10));
    CHECK(segment.event_velocity == Approx(-velocity).epsilon(1e-10));
    CHECK(segment.after(1) == Approx(r * velocity).epsilon(1e-10));
    velocity *= r;
    time += 2.0 * velocity / g;
  }
}

TEST_CASE("linear oscillator: every segment up to an impact follows the closed form, and the first fall ends it") {
  const IntegrationMethod method = GENERATE(IntegrationMethod::adams, IntegrationMethod::runge_kutta);
  const HybridSystem& system = system_of<LinearOscillator>();
  const ParameterVector par = parameters({3.2, 2.0072, 0.05, 0.8});
  const Simulated run =
      simulate(ModeRule(system, std::vector<Mode>{Mode{{{1, 1, 1}}, {}}}), Vector4d(0.2, 0.1, 0.0, 1.0), par,
               so_many_events(30), settings_for_tests(1e-12, method));
  REQUIRE(run.segments.size() == 30);
  for (const SimulatedSegment& segment : run.segments) {
    CAPTURE(segment.number);
    REQUIRE(segment.ended_by == SegmentEnd::event);
    const VectorXd expected = linear_flow(segment.start, par, segment.duration);
    CHECK((segment.end - expected).lpNorm<Eigen::Infinity>() < 1e-9);
    CHECK(std::abs(segment.end(0) - 1.0) < 1e-12);
    CHECK(segment.event_velocity == Approx(-segment.end(1)));
    CHECK(segment.end(1) > 0.0);
    double highest = -1e9;  // away from both ends
    for (int k = 50; k <= 950; ++k)
      highest = std::max(highest, linear_flow(segment.start, par, segment.duration * k / 1000.0)(0));
    CHECK(highest < 1.0);
    CHECK(segment.after(1) == Approx(-0.8 * segment.end(1)));
  }
}

TEST_CASE("a pair of crossings much shorter than a step is found, a miss by as little is a contact") {
  const IntegrationMethod method = GENERATE(IntegrationMethod::adams, IntegrationMethod::runge_kutta);
  // x = A cos(w t), A just beyond the wall or just before it; the tolerance allows steps of a tenth of a period.
  const double w = 1.3;
  for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
    for (const double depth : {1e-3, 1e-5, 1e-7, 1e-9}) {
      CAPTURE(tolerance, depth);
      // From the minimum: the maximum comes after half a period. With an error of integration of much more than
      // `depth` nothing can be said.
      if (depth < 20.0 * tolerance) continue;
      const Simulated hit = simulate(always<TwoWalls>({{1, 1, 1}}), Vector4d(-1.0 - depth, 0.0, 1.0, 0.0),
                                     parameters({w, 1.0}), so_many_events(1), settings_for_tests(tolerance, method));
      REQUIRE(hit.segments.size() == 1);
      REQUIRE(hit.segments[0].ended_by == SegmentEnd::event);
      const double early = std::acos(1.0 / (1.0 + depth)) / w;
      const double time = pi / w - early;
      CHECK(std::abs(hit.segments[0].duration - time) < 0.2 * early + 20.0 * tolerance);

      const Simulated miss = simulate(always<TwoWalls>({{1, 1, 1}}), Vector4d(-1.0 + depth, 0.0, 1.0, 0.0),
                                      parameters({w, 1.0}), so_long(5.0), settings_for_tests(tolerance, method));
      REQUIRE(miss.segments.size() == 1);
      CHECK(miss.segments[0].ended_by == SegmentEnd::end_time);
      REQUIRE(miss.segments[0].marks.size() == 1);
      const SegmentMark& contact = miss.segments[0].marks[0];
      CHECK(contact.kind == SegmentMark::Kind::contact);
      CHECK(contact.event == 1);
      CHECK(contact.time == Approx(pi / w).margin(20.0 * tolerance));
      CHECK(contact.h == Approx(depth).margin(20.0 * tolerance));
      CHECK(miss.result.contacts == 1);
    }
  }
}

TEST_CASE("a minimum of h that is not near zero is no contact") {
  const Simulated miss =
      simulate(always<TwoWalls>({{1, 1, 1}}), Vector4d(-0.9, 0.0, 1.0, 0.0), parameters({1.3, 1.0}), so_long(20.0));
  CHECK(miss.result.contacts == 0);
}

TEST_CASE("two events at once: the first in the order of the index vectors goes first, the other one at once after") {
  const IntegrationMethod method = GENERATE(IntegrationMethod::adams, IntegrationMethod::runge_kutta);
  // x reaches 1 = 2 sin(w t) at w t = pi / 6; y falls to zero at the same time.
  const double w = 1.3, time = pi / 6.0 / w, r = 0.5;
  const Vector4d start(0.0, 2.0 * w, time, -1.0);
  for (const bool wall_first : {true, false}) {
    CAPTURE(wall_first);
    const IndexVector wall{1, 1, 1}, floor{1, 2, 2};
    const std::vector<IndexVector> order =
        wall_first ? std::vector<IndexVector>{wall, floor} : std::vector<IndexVector>{floor, wall};
    const Simulated run = simulate(always<TwoWalls>(order), start, parameters({w, r}), so_many_events(2),
                                   settings_for_tests(1e-12, method));
    REQUIRE(run.segments.size() == 2);
    CHECK(run.segments[0].index == order[0]);
    REQUIRE(run.segments[0].simultaneous.size() == 1);
    CHECK(run.segments[0].simultaneous[0] == order[1]);
    CHECK(run.segments[0].duration == Approx(time).epsilon(1e-10));
    CHECK(run.segments[1].index == order[1]);
    CHECK(run.segments[1].duration == 0.0);
    CHECK(run.segments[1].simultaneous.empty());
    CHECK(run.result.simultaneous == 1);
    const double speed = 2.0 * w * std::cos(pi / 6.0);
    CHECK((run.segments[1].after - Vector4d(1.0, -r * speed, 0.0, r)).lpNorm<Eigen::Infinity>() < 1e-9);
  }
}

TEST_CASE("events that nearly coincide come in their own order") {
  const IntegrationMethod method = GENERATE(IntegrationMethod::adams, IntegrationMethod::runge_kutta);
  const double w = 1.3, time = pi / 6.0 / w;
  for (const double later : {1e-4, -1e-4, 1e-6, -1e-6}) {
    CAPTURE(later);
    const Simulated run = simulate(always<TwoWalls>({{1, 1, 1}, {1, 2, 2}}), Vector4d(0.0, 2.0 * w, time + later, -1.0),
                                   parameters({w, 0.5}), so_many_events(2), settings_for_tests(1e-12, method));
    REQUIRE(run.segments.size() == 2);
    CHECK(run.segments[0].index.event == (later > 0.0 ? 1 : 2));
    CHECK(run.segments[1].index.event == (later > 0.0 ? 2 : 1));
    CHECK(run.result.simultaneous == 0);
    CHECK(run.segments[1].duration == Approx(std::abs(later)).epsilon(1e-3));
  }
}

TEST_CASE("a start beyond a wall is told, a monitored function below zero is a violation, with its time") {
  const double w = 1.3;
  const Simulated beyond =
      simulate(always<TwoWalls>({{1, 1, 1}}), Vector4d(1.5, 0.1, 1.0, 0.0), parameters({w, 0.5}), so_long(1.0));
  CHECK(beyond.result.beyond == 1);

  // Cut at the maximum, event 3, while x goes beyond the wall.
  const ModeRule rule(system_of<TwoWalls>(), std::vector<Mode>{Mode{{{1, 3, 3}}, {1}}});
  const Simulated run = simulate(rule, Vector4d(0.0, 2.0 * w, 1.0, 0.0), parameters({w, 0.5}), so_many_events(1));
  REQUIRE(run.segments.size() == 1);
  CHECK(run.segments[0].index == IndexVector{1, 3, 3});
  CHECK(run.segments[0].duration == Approx(pi / 2.0 / w).epsilon(1e-10));
  REQUIRE(run.result.violations == 1);
  CHECK(run.segments[0].marks[0].event == 1);
  CHECK(run.segments[0].marks[0].time == Approx(pi / 6.0 / w).epsilon(1e-10));
}

TEST_CASE(
    "a start on a surface that the motion goes through: a jump that changes the state happens, a section does not") {
  const double a = 3.2, c = 0.3;
  const Simulated clock =
      simulate(always<LogisticClock>({{1, 1, 1}}), Eigen::Vector3d(1.0, c, 0.0), parameters({a}), so_many_events(2));
  REQUIRE(clock.segments.size() == 2);
  CHECK(clock.segments[0].duration == 0.0);
  CHECK(clock.segments[0].after(1) == Approx(a * c * (1.0 - c)));
  CHECK(clock.segments[1].duration == Approx(1.0));

  const double w = 1.3;  // at a maximum of x, event 3
  const Simulated cut =
      simulate(always<TwoWalls>({{1, 3, 3}}), Vector4d(0.5, 0.0, 1.0, 0.0), parameters({w, 0.5}), so_many_events(1));
  REQUIRE(cut.segments.size() == 1);
  CHECK(cut.segments[0].duration == Approx(2.0 * pi / w));
}

TEST_CASE("lengths: time after a transient, events after a transient, no event within the patience") {
  const ParameterVector par = parameters({1.3, 1.0});
  const double period = 2.0 * pi / 1.3;
  SimulationPlan plan = so_many_events(3);
  plan.transient_events = 2;
  Simulated run = simulate(always<TwoWalls>({{1, 3, 3}}), Vector4d(0.5, 0.0, 1.0, 0.0), par, plan);
  CHECK(run.result.events == 5);
  CHECK(run.result.dropped == 2);
  REQUIRE(run.segments.size() == 3);
  CHECK(run.segments[0].start_time == Approx(2.0 * period).epsilon(1e-10));

  plan = so_long(2.5 * period);
  plan.transient_time = 1.5 * period;  // two segments begin before that
  run = simulate(always<TwoWalls>({{1, 3, 3}}), Vector4d(0.5, 0.0, 1.0, 0.0), par, plan);
  CHECK(run.result.last.ended_by == SegmentEnd::end_time);
  CHECK(run.result.last.end_time() == Approx(4.5 * period).epsilon(1e-10));

  SimulationSettings impatient = settings_for_tests();
  impatient.flow.max_duration = 7.0;
  run = simulate(always<TwoWalls>({{1, 1, 1}}), Vector4d(0.5, 0.0, 1.0, 0.0), par, {}, impatient);
  CHECK(run.result.last.ended_by == SegmentEnd::no_event);
  CHECK(run.result.last.end_time() == Approx(7.0));
}

TEST_CASE("samples of a segment: in order, with both ends, no more than asked for, none when none are wanted") {
  for (const std::size_t wanted : {std::size_t{0}, std::size_t{2}, std::size_t{7}, std::size_t{200}}) {
    SimulationSettings settings = settings_for_tests();
    settings.samples = wanted;
    const Simulated run = simulate(always<TwoWalls>({{1, 3, 3}}), Vector4d(0.5, 0.0, 1.0, 0.0), parameters({1.3, 1.0}),
                                   so_many_events(2), settings);
    const std::vector<Sample>& samples = run.segments.back().samples;
    CHECK(samples.size() <= wanted);
    if (wanted == 0) continue;
    CHECK(samples.front().time == run.segments.back().start_time);
    CHECK(samples.back().time == run.segments.back().end_time());
    CHECK(std::is_sorted(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.time < b.time; }));
    for (const Sample& sample : samples)
      CHECK(sample.state(0) == Approx(0.5 * std::cos(1.3 * sample.time)).margin(1e-9));
  }
}

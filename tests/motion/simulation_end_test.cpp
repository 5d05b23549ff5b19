// What a simulation settles on: chattering, sticking, rest, periodic orbits of any period.
#include <catch2/catch.hpp>

#include "../model/linear_oscillator.hpp"
#include "motion/found_orbit.hpp"
#include "motion/settle.hpp"
#include "simulated_problems.hpp"

using namespace tchat;
using namespace tchat::test;
using Catch::Matchers::Contains;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// A damped oscillator, PAR(1) its damping; event 1: maximum of x.
struct Damped {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1], f[1] = -x[0] - p[0] * x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1];
  }
};

/// x'' = -x - p x' + cos t, with (sin t, cos t) as a clock that attracts; event 1: maximum of x.
struct Driven {
  static constexpr int dimension = 4, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1], f[1] = -x[0] - p[0] * x[1] + x[3];
    f[2] = growth * x[2] + x[3], f[3] = growth * x[3] - x[2];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
  }
};

Simulated logistic(double a, int max_period, double transient = 20000.0) {
  SimulationPlan plan;
  plan.transient_time = transient;
  plan.max_period = max_period;
  plan.recognition = 1e-8;
  plan.most_events = 500;
  SimulationSettings settings = settings_for_tests();
  settings.samples = 0;
  return simulate(always<LogisticClock>({{1, 1, 1}}), Vector3d(0.0, 0.4, 0.0), parameters({a}), plan, settings);
}

}  // namespace

TEST_CASE("chattering: the ball's impacts accumulate at the time of the closed form") {
  const double g = 9.81, height = 2.0;
  for (const double r : {0.3, 0.5, 0.8, 0.95}) {
    CAPTURE(r);
    const double first = std::sqrt(2.0 * height / g);
    const double limit = first + 2.0 * first * r / (1.0 - r);
    const Simulated ball = simulate(always<BouncingBall>({{1, 1, 1}}), Vector2d(height, 0.0), parameters({g, r}), {});
    REQUIRE(ball.result.accumulation);
    CHECK_FALSE(ball.result.is_periodic());
    CHECK(ball.result.accumulation->pattern == 1);
    CHECK(ball.result.accumulation->ratio == Approx(r).epsilon(1e-4));  // of durations as short as 1e-6
    CHECK(ball.result.last.end_time() + ball.result.accumulation->remaining == Approx(limit).epsilon(1e-9));
  }
}

TEST_CASE("chattering of several kinds of events: impact, top of the flight, impact, ...") {
  const double g = 9.81, r = 0.6, height = 2.0;
  const double first = std::sqrt(2.0 * height / g);
  const Simulated ball =
      simulate(always<BouncingBall>({{1, 1, 1}, {1, 2, 2}}), Vector2d(height, 0.0), parameters({g, r}), {});
  REQUIRE(ball.result.accumulation);
  CHECK(ball.result.accumulation->pattern == 2);
  CHECK(ball.result.accumulation->ratio == Approx(r).epsilon(1e-6));
  CHECK(ball.result.last.end_time() + ball.result.accumulation->remaining ==
        Approx(first + 2.0 * first * r / (1.0 - r)).epsilon(1e-9));
}

TEST_CASE("a ball that loses nothing, or gains, does not chatter") {
  SimulationPlan plan = so_many_events(200);
  for (const double r : {1.0, 1.01}) {
    const Simulated ball = simulate(always<BouncingBall>({{1, 1, 1}}), Vector2d(2.0, 0.0), parameters({9.81, r}), plan);
    CHECK_FALSE(ball.result.accumulation);
    CHECK(ball.result.events == 200);
  }
}

TEST_CASE("a ball that gains at each impact escapes, whatever the length units") {
  SimulationSettings settings = settings_for_tests();
  settings.flow.max_duration = 1e12;
  for (const double unit : {1.0, 1e-6, 1e6}) {
    const Simulated ball = simulate(always<BouncingBall>({{1, 1, 1}}), Vector2d(2.0 * unit, 0.0),
                                    parameters({9.81 * unit, 1.1}), {}, settings);
    INFO(unit);
    CHECK(ball.result.end == MotionEnd::escapes);
    CHECK(ball.result.events > 16 + 100);
  }
}

TEST_CASE("an impact that leaves no velocity sticks, and is told") {
  const Simulated ball = simulate(always<BouncingBall>({{1, 1, 1}}), Vector2d(2.0, 0.0), parameters({9.81, 0.0}), {});
  CHECK(ball.result.last.ended_by == SegmentEnd::sticks);
  CHECK(ball.result.events == 1);
  CHECK_THAT(ball.result.last.message, Contains("the contact lasts"));
}

TEST_CASE("an orbit is recognised after the same number of events whatever samples are kept") {
  // x'' = -x - 0.1 x' + cos t between events at the maxima of x: x = 10 sin t with range 20, cut where x' = 0, so that
  // the ends of segments alone show no range at all.
  const ModeRule rule = always<Driven>({{1, 1, 1}});
  std::vector<long> events;
  for (const std::size_t samples : {200, 0, 1, 2, 7}) {
    SimulationSettings settings = settings_for_tests();
    settings.samples = samples;
    const Simulated run = simulate(rule, Eigen::Vector4d(0.0, 0.0, 0.0, 1.0), parameters({0.1}), {}, settings);
    REQUIRE(run.result.is_periodic());
    const SimulatedSegment& turn = run.result.turn.segments.front();
    CHECK(turn.low(0) == Approx(-10.0).epsilon(1e-3));
    CHECK(turn.high(0) == Approx(10.0).epsilon(1e-3));
    events.push_back(run.result.events);
  }
  CHECK(events == std::vector<long>(events.size(), events.front()));
}

TEST_CASE("a motion that dies out is no periodic orbit") {
  const Simulated damped = simulate(always<Damped>({{1, 1, 1}}), Vector2d(1.0, 0.0), parameters({0.1}), {});
  CHECK(damped.result.end == MotionEnd::settled);
  CHECK_FALSE(damped.result.is_periodic());
  REQUIRE(damped.result.equilibrium);
  CHECK(damped.result.equilibrium->norm() < 1e-10);
  // exp(-0.05 t) = 1e-12, and a few events more: then its events say so themselves.
  DecayDetector decay;
  double dead = 0.0;
  for (const SimulatedSegment& segment :
       simulate(always<Damped>({{1, 1, 1}}), Vector2d(1.0, 0.0), parameters({0.1}), so_many_events(120)).segments) {
    decay.add(segment.index, segment.event_velocity);
    if (dead == 0.0 && decay.dies_out()) dead = segment.end_time();
  }
  const double expected = 20.0 * std::log(1e12);
  CHECK(dead > expected);
  CHECK(dead < expected + 6.0 * 2.0 * pi);
  // Slow decay is not taken for an orbit either, while it lasts.
  const Simulated slow =
      simulate(always<Damped>({{1, 1, 1}}), Vector2d(1.0, 0.0), parameters({1e-4}), so_many_events(100));
  CHECK_FALSE(slow.result.is_periodic());
}

TEST_CASE("periodic orbits of 1 to 32 events: the logistic map's cascade", "[slow]") {
  struct Cycle {
    double a;
    int period;
  };
  for (const Cycle& cycle : {Cycle{2.8, 1}, Cycle{3.2, 2}, Cycle{3.5, 4}, Cycle{3.55, 8}, Cycle{3.566, 16},
                             Cycle{3.832, 3}, Cycle{3.739, 5}}) {
    CAPTURE(cycle.a);
    const Simulated run = logistic(cycle.a, 16);
    REQUIRE(run.result.is_periodic());
    CHECK(static_cast<int>(run.result.turn.segments.size()) == cycle.period);
    double c = run.result.turn.segments.front().start(1);
    double advance = 0.0, multiplier = 1.0;
    for (int k = 0; k < cycle.period; ++k) {
      advance += c;
      multiplier *= cycle.a * (1.0 - 2.0 * c);
      c = cycle.a * c * (1.0 - c);
    }
    CHECK(c == Approx(run.result.turn.segments.front().start(1)).epsilon(1e-7));

    // s, on which nothing depends, may advance.
    CHECK(run.result.turn.ignorable == std::vector<Eigen::Index>{2});
    const FoundOrbit orbit = refine(system_of<LogisticClock>(), run.result.turn, parameters({cycle.a}), {0, 0, 0});
    REQUIRE(orbit.converged);
    CHECK(static_cast<int>(orbit.signature.size()) == cycle.period);
    CHECK(orbit.map.period == Approx(cycle.period).epsilon(1e-12));
    CHECK(orbit.advance(2) == Approx(advance).epsilon(1e-7));
    REQUIRE(orbit.multipliers.size() == 2);
    CHECK(orbit.multipliers[0].real() == Approx(multiplier).margin(1e-5));
    CHECK(orbit.stability() == OrbitStability::stable);
  }
  CHECK_FALSE(logistic(3.569, 16).result.is_periodic());
  CHECK(logistic(3.569, 32, 100000.0).result.turn.segments.size() == 32);
  CHECK_FALSE(logistic(3.9, 16).result.is_periodic());  // chaotic
}

TEST_CASE("a state is ignorable only when no function depends on it and jumps pass it on") {
  const ParameterVector par = parameters({3.2});
  const std::vector<VectorXd> points{Vector3d(0.1, 0.4, 2.0), Vector3d(0.9, 0.3, 5.0)};
  CHECK(ignorable_states(system_of<LogisticClock>(), points, par) == std::vector<bool>{false, false, true});
  CHECK(ignorable_states(system_of<LogisticClock>(), {}, par) == std::vector<bool>{false, false, false});
  CHECK(ignorable_states(system_of<BouncingBall>(), {Vector2d(1.0, 2.0)}, parameters({9.81, 0.5})) ==
        std::vector<bool>{false, false});
}

TEST_CASE("an orbit is refined from its lowest index vector on, or from the one wanted") {
  SimulationPlan plan;
  const ModeRule rule(system_of<BouncingBall>(), std::vector<Mode>{Mode{{{1, 2, 2}}, {}}, Mode{{{1, 1, 1}}, {}}});
  const Simulated run = simulate(rule, Vector2d(0.5, 1.0), parameters({9.81, 1.0}), plan);
  REQUIRE(run.result.is_periodic());
  // Neutral: shooting may say that its matrix is singular, but the order stands.
  const FoundOrbit lowest = refine(system_of<BouncingBall>(), run.result.turn, parameters({9.81, 1.0}), {0, 0, 0});
  CHECK(lowest.signature == Signature{{1, 1, 1}, {1, 2, 2}});
  const FoundOrbit wanted = refine(system_of<BouncingBall>(), run.result.turn, parameters({9.81, 1.0}), {1, 2, 2});
  CHECK(wanted.signature == Signature{{1, 2, 2}, {1, 1, 1}});
}

TEST_CASE("an orbit whose events shooting does not find again is a value") {
  // Thrown upwards where the ball falls upwards: the floor is never met again.
  SimulatedSegment segment;
  segment.mode = {{{1, 1, 1}}, {}};
  segment.index = {1, 1, 1};
  segment.start = segment.low = Vector2d(0.0, 1.0);
  segment.high = segment.end = Vector2d(1.0, 2.0);
  SimulationResult result;
  result.turn.segments = {segment, segment};
  const FoundOrbit found = refine(system_of<BouncingBall>(), result.turn, parameters({-9.81, 1.0}), {0, 0, 0});
  CHECK_FALSE(found.converged);
  CHECK_THAT(found.message, Contains("segment 1"));
}

TEST_CASE("sections end no segments of an orbit that has another end, wherever the turn begins") {
  const HybridSystem& hybrid = system_of<LinearOscillator>();
  const auto segment = [](IndexVector index, double begin, double duration) {
    SimulatedSegment s;
    s.index = index;
    s.mode = {{index}, {}};
    s.start_time = begin;
    s.duration = duration;
    s.start = Eigen::Vector4d(begin, 0.0, 0.0, 1.0);
    s.low = s.high = s.start;
    return s;
  };
  const IndexVector impact{1, 1, 1}, section{1, 3, 2};
  std::vector<SimulatedSegment> turn{segment(section, 0.0, 1.0), segment(impact, 1.0, 2.0), segment(section, 3.0, 3.0),
                                     segment(section, 6.0, 4.0), segment(impact, 10.0, 5.0)};
  for (std::size_t turned = 0; turned < turn.size(); ++turned) {
    CAPTURE(turned);
    std::vector<double> durations, starts;
    for (const SimulatedSegment& s : without_sections(hybrid, turn)) {
      CHECK(s.index == impact);
      CHECK(s.mode.index_vectors == std::vector<IndexVector>{impact, section});
      CHECK(s.low(0) == s.start(0));
      durations.push_back(s.duration);
      starts.push_back(s.start(0));
    }
    std::sort(durations.begin(), durations.end());
    std::sort(starts.begin(), starts.end());
    CHECK(durations == std::vector<double>{3.0, 12.0});
    CHECK(starts == std::vector<double>{0.0, 3.0});
    std::rotate(turn.begin(), turn.begin() + 1, turn.end());
  }
  const std::vector<SimulatedSegment> only{segment(section, 0.0, 1.0), segment(section, 1.0, 1.0)};
  CHECK(without_sections(hybrid, only).size() == 2);
}

TEST_CASE("a simulation that is interrupted ends at once") {
  SimulationSettings settings = settings_for_tests();
  int calls = 0;
  settings.interrupted = [&calls] { return ++calls > 50; };
  const Simulated run =
      simulate(always<Damped>({{1, 1, 1}}), Vector2d(1.0, 0.0), parameters({0.0}), so_long(1e9), settings);
  CHECK(run.result.last.ended_by == SegmentEnd::interrupted);
  CHECK(calls == 51);
}

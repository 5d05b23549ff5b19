// What a simulation settles on: orbits corrected by Newton's method, stable ones that are approached, and no others.
#include <catch2/catch.hpp>
#include <cmath>

#include "lyapunov_problems.hpp"
#include "motion/attractor_search.hpp"
#include "motion/growth_series.hpp"
#include "motion/recurrence.hpp"
#include "support/linear_oscillator.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::VectorXd;

namespace {

/// x = (clock, c), c -> PAR(1) c (1 - c) once per unit of time; period 1 at c = 1 - 1 / a with the multiplier 2 - a.
struct Clocked {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T*, const T*, T* f) const {
    f[0] = T(1.0), f[1] = T(0.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0] - 1.0, g[1] = p[0] * x[1] * (1.0 - x[1]);
  }
};

/// x, y attract to the unit circle, z' = -PAR(1) z; event 1 where y falls through zero. Period 2 pi, multiplier
/// exp(-2 pi PAR(1)).
struct SlowMode {
  static constexpr int dimension = 3, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T growth = 1.0 - x[0] * x[0] - x[1] * x[1];
    f[0] = growth * x[0] - x[1];
    f[1] = growth * x[1] + x[0];
    f[2] = -p[0] * x[2];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[1];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
  }
};

/// x = (clock, c, s), PAR = (a, b): once per unit of time z = c + i s goes to e^{i a} (w + b) / (1 + b w), w = z
/// (3 - |z|^2) / 2.
struct Moebius {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T*, const T*, T* f) const {
    f[0] = T(1.0), f[1] = T(0.0), f[2] = T(0.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    using std::cos;
    using std::sin;
    const T growth = 0.5 * (3.0 - x[1] * x[1] - x[2] * x[2]);
    const T c = growth * x[1], s = growth * x[2];
    const T size = (1.0 + p[1] * c) * (1.0 + p[1] * c) + p[1] * s * p[1] * s;
    const T u = ((c + p[1]) * (1.0 + p[1] * c) + p[1] * s * s) / size;
    const T v = (s * (1.0 + p[1] * c) - (c + p[1]) * p[1] * s) / size;
    g[0] = T(0.0), g[1] = cos(p[0]) * u - sin(p[0]) * v, g[2] = sin(p[0]) * u + cos(p[0]) * v;
  }
};

/// A focus at the origin, x' = -PAR(1) x - y, y' = x - PAR(1) y; event 1 where y falls through zero.
struct Focus {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = -p[0] * x[0] - x[1], f[1] = x[0] - p[0] * x[1];
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

struct Settled {
  std::optional<VectorXd> equilibrium;
  std::optional<SettledOrbit> orbit;
  std::string doubt;
  long events = 0;
};

Settled settle(const ModeRule& rule, const VectorXd& x0, const ParameterVector& par, long most_events) {
  SimulationSettings settings = settings_for_tests(1e-10);
  settings.samples = 0;
  HybridSimulation simulation(rule, x0, par, settings);
  AttractorSearch search(16, 1e-6, settings);
  Settled settled;
  while (settled.events < most_events) {
    const SimulatedSegment segment = simulation.next(1e300);
    if (segment.ended_by != SegmentEnd::event) break;
    ++settled.events;
    if (search.has_settled(simulation, segment)) break;
  }
  settled.orbit = search.orbit();
  settled.equilibrium = search.equilibrium();
  settled.doubt = search.doubt();
  return settled;
}

}  // namespace

TEST_CASE("an orbit that attracts is found with its multipliers") {
  const OscillatorOrbit orbit = one_impact_orbit(2.0072, 1.0);
  const ModeRule rule(linosc(), std::vector<Mode>{Mode{{IndexVector{1, 1, 1}, IndexVector{1, 2, 2}}, {}}});
  const Settled settled = settle(rule, orbit.state(0.1), orbit.par(), 1000);
  REQUIRE(settled.orbit.has_value());
  CHECK(settled.orbit->stability == OrbitStability::stable);
  REQUIRE(settled.orbit->turn.size() == 1);
  CHECK(settled.orbit->turn.front().duration == Approx(orbit.constants.period()).epsilon(1e-7));
  double largest = 0.0;
  for (const auto& mu : one_impact_multipliers(2.0072, 1.0)) largest = std::max(largest, std::abs(mu));
  CHECK(std::abs(settled.orbit->multipliers.front()) == Approx(largest).epsilon(1e-6));
}

TEST_CASE(
    "near a period doubling the shorter orbit is the attractor as long as it is stable, and then the longer one") {
  const ModeRule clock = always<Clocked>({{1, 1, 1}});
  for (const double a : {2.99, 2.997, 2.999, 2.9999}) {
    CAPTURE(a);
    const Settled settled = settle(clock, Eigen::Vector2d(0.0, 0.6), parameters({a}), 4000);
    REQUIRE(settled.orbit.has_value());
    CHECK(settled.orbit->turn.size() == 1);
    CHECK(settled.orbit->stability == OrbitStability::stable);
    CHECK(std::abs(settled.orbit->multipliers.front()) == Approx(a - 2.0).margin(1e-7));
  }
  for (const double a : {3.001, 3.01, 3.1}) {
    CAPTURE(a);
    // Also from next to the unstable orbit at 1 - 1 / a, where the motion stays for some time.
    for (const double start : {0.6, 1.0 - 1.0 / a + 1e-9}) {
      const Settled settled = settle(clock, Eigen::Vector2d(0.0, start), parameters({a}), 50000);
      REQUIRE(settled.orbit.has_value());
      CHECK(settled.orbit->turn.size() == 2);
      CHECK(settled.orbit->stability == OrbitStability::stable);
      // 4 + 2 a - a^2
      CHECK(settled.orbit->multipliers.front().real() == Approx(4.0 + 2.0 * a - a * a).margin(1e-6));
    }
  }
}

TEST_CASE("an orbit that the motion does not leave is none that attracts it") {
  const double a = 3.3;
  const Settled settled =
      settle(always<Clocked>({{1, 1, 1}}), Eigen::Vector2d(0.0, 1.0 - 1.0 / a), parameters({a}), 30);
  CHECK_FALSE(settled.orbit.has_value());
  CHECK(settled.doubt.find("no attractor") != std::string::npos);
}

TEST_CASE("slow modes: the orbit is found long before the motion has come to it") {
  const ModeRule rule = always<SlowMode>({{1, 1, 1}});
  for (const double rate : {1e-3, 1e-5, 1e-7}) {
    CAPTURE(rate);
    const Settled settled = settle(rule, Eigen::Vector3d(1.0, 0.1, 1.0), parameters({rate}), 4000);
    REQUIRE(settled.orbit.has_value());
    CHECK(settled.orbit->stability == OrbitStability::stable);
    CHECK(settled.orbit->turn.size() == 1);
    const double gap = 1.0 - std::abs(settled.orbit->multipliers.front());
    CHECK(gap == Approx(-std::expm1(-2.0 * std::acos(-1.0) * rate)).epsilon(0.02).margin(2e-8));
    CHECK(std::abs(settled.orbit->turn.front().start(2)) < 1e-3);
  }
  // The other way round the mode grows.
  CHECK_FALSE(settle(rule, Eigen::Vector3d(1.0, 0.1, 1e-3), parameters({-1e-5}), 1000).orbit.has_value());
}

TEST_CASE("a state that nothing depends on may grow, chaos and tori settle on no orbit") {
  const ModeRule logistic = always<LogisticClock>({{1, 1, 1}});
  CHECK(settle(logistic, Eigen::Vector3d(0.0, 0.1234, 0.0), parameters({3.55}), 3000).orbit->turn.size() == 8);
  CHECK_FALSE(settle(logistic, Eigen::Vector3d(0.0, 0.1234, 0.0), parameters({4.0}), 3000).orbit.has_value());
  const ParameterVector golden = parameters({1.0, 0.5 * (std::sqrt(5.0) - 1.0)});
  CHECK_FALSE(
      settle(always<TwoCircles>({{1, 1, 1}}), Eigen::Vector4d(1.0, 0.1, 0.6, 0.8), golden, 1000).orbit.has_value());
}

TEST_CASE("a stable orbit far from a motion on a circle is none that it approaches") {
  // Off the unit circle the map has a fixed point that attracts (moduli 0.257 and 0.229), at (3.65, -2.01); on it none.
  const Settled settled =
      settle(always<Moebius>({{1, 1, 1}}), Eigen::Vector3d(0.0, 0.36456096879362471, 0.93117952084023725),
             parameters({-0.56789320700131429, 0.26676600878645029}), 3000);
  CHECK_FALSE(settled.orbit.has_value());
}

TEST_CASE("a motion of a conservative system that repeats itself is periodic, and neutral") {
  // A ball that loses nothing: period 2 sqrt(2 h / g) * ..., every height its own orbit.
  const ModeRule ball = always<BouncingBall>({{1, 1, 1}});
  const Settled settled = settle(ball, Eigen::Vector2d(1.0, 0.0), parameters({1.0, 1.0}), 1000);
  REQUIRE(settled.orbit.has_value());
  CHECK(settled.orbit->stability == OrbitStability::neutral);
  CHECK(settled.orbit->turn.front().duration == Approx(2.0 * std::sqrt(2.0)).epsilon(1e-8));
}

TEST_CASE("a motion that comes to rest is no orbit, however small its turns have become") {
  for (const double damping : {0.05, 0.01, 1e-4}) {
    CAPTURE(damping);
    const Settled settled = settle(always<Focus>({{1, 1, 1}}), Eigen::Vector2d(1.0, 0.0), parameters({damping}), 400);
    CHECK_FALSE(settled.orbit.has_value());
    REQUIRE(settled.equilibrium.has_value());
    CHECK(settled.equilibrium->norm() < 1e-9);
  }
}

TEST_CASE("an equilibrium that attracts, and motions that do not come to one") {
  const HybridSystem& system = system_of<CutDiagonal>();
  const IndexVector index{1, 1, 1};
  const auto at_distances = [](const std::vector<double>& distances) {
    std::vector<VectorXd> states;
    for (const double d : distances) states.push_back(Eigen::Vector3d(d, d, d));
    return states;
  };
  const std::vector<double> falling{1.0, 0.5, 0.2, 0.1};
  const ParameterVector sink = parameters({-1.0, -2.0, -1.0});
  REQUIRE(approached_equilibrium(system, index, at_distances(falling), 4, sink, {}, Eigen::Vector3d::Ones(), 1e-12)
              .has_value());
  CHECK(approached_equilibrium(system, index, at_distances(falling), 4, sink, {}, Eigen::Vector3d::Ones(), 1e-12)
            ->norm() < 1e-12);
  const auto refused = [&](const HybridSystem& by, const std::vector<double>& distances, const ParameterVector& par) {
    return !approached_equilibrium(by, index, at_distances(distances), 4, par, {}, Eigen::Vector3d::Ones(), 1e-12)
                .has_value();
  };
  CHECK(refused(system, falling, parameters({1.0, -2.0, -1.0})));
  CHECK(refused(system, {0.1, 0.2, 0.5, 1.0}, sink));
  CHECK(refused(system, {2.0, 1.5, 1.25, 1.125, 1.0625}, sink));                        // towards a cycle at distance 1
  CHECK(refused(system, {1.0, 1.0 - 1e-8, 1.0 - 2e-8, 1.0 - 3e-8, 1.0 - 4e-8}, sink));  // no more than errors
  CHECK(refused(system, {0.1, 1.0, 0.5, 0.2}, sink));                                   // too few of them
  CHECK_FALSE(refused(system, {0.1, 1.0, 0.5, 0.2, 0.1}, sink));
  CHECK_FALSE(refused(system, {1.0, 2.0, 1e-9, 2e-9, 1e-9, 3e-9}, sink));  // at rest after a beat
  CHECK(refused(system_of<Diagonal>(), falling, sink));                    // no state at this event can be near it
}

TEST_CASE("the signs of exponents, that along the flow left out") {
  LyapunovSpectrum s;
  s.time = 100.0;
  s.events = 100;
  const auto kind = [&](std::initializer_list<double> exponents, std::initializer_list<double> errors,
                        std::vector<Eigen::Index> structural) {
    s.exponents = Eigen::Map<const VectorXd>(exponents.begin(), static_cast<Eigen::Index>(exponents.size()));
    s.errors = Eigen::Map<const VectorXd>(errors.begin(), static_cast<Eigen::Index>(errors.size()));
    s.structural = std::move(structural);
    return kind_by_exponents(s);
  };
  CHECK(kind({0.1, 0.0, -1.0}, {0.01, 0.01, 0.01}, {1}) == AttractorKind::chaotic);
  CHECK(kind({2e-5, 0.0, -1.0}, {1e-5, 1e-5, 0.01}, {1}) == AttractorKind::quasi_periodic);
  CHECK(kind({0.02, 0.0, -1.0}, {0.01, 0.001, 0.01}, {1}) == AttractorKind::none);  // a torus, or weak chaos
  CHECK(kind({0.02, 0.0, -1.0}, {0.1, 0.01, 0.01}, {1}) == AttractorKind::none);
  CHECK(kind({0.0, -0.5, -INFINITY}, {0.001, 0.01, 0.0}, {0}) == AttractorKind::periodic);
  // However far the mean along the flow is from zero, by chance or by bias.
  CHECK(kind({2.2e-5, -0.5}, {5.6e-6, 0.01}, {0}) == AttractorKind::periodic);
  CHECK(kind({-0.1, -0.5, -1.0}, {0.01, 0.01, 0.0}, {}) == AttractorKind::rest);
  CHECK(kind({0.0}, {0.01}, {0}) == AttractorKind::none);  // one exponent does not tell
  CHECK(kind({NAN, 0.0}, {INFINITY, 0.01}, {1}) == AttractorKind::none);
}

namespace {

/// A ball in a rectangle of width p0 and height 1.
struct Billiard {
  static constexpr int dimension = 4, parameters = 1, fields = 1, events = 4, jumps = 2;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = x[2], f[1] = x[3], f[2] = T(0.0), f[3] = T(0.0);
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(p[0] - x[0]) : j == 2 ? T(x[0]) : j == 3 ? T(1.0 - x[1]) : T(x[1]);
  }
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1], g[2] = k == 1 ? T(-x[2]) : T(x[2]), g[3] = k == 2 ? T(-x[3]) : T(x[3]);
  }
};

SimulatedSegment at_event(double x) {
  SimulatedSegment segment;
  segment.index = {1, 1, 1};
  segment.end = segment.low = segment.high = Eigen::VectorXd::Constant(1, x);
  return segment;
}

}  // namespace

TEST_CASE("a ball that flies about comes to no rest, however its places at one wall lie") {
  // Rest is everywhere where nothing moves, and places at the roof come near one of them by chance.
  const Simulated flight = simulate(always<Billiard>({{1, 1, 1}, {1, 2, 1}, {1, 3, 2}, {1, 4, 2}}),
                                    Eigen::Vector4d(0.1, 0.2, 1.0, 0.46274973070065073),
                                    parameters({1.8256371116848349}), {}, settings_for_tests(1e-10));
  CHECK_FALSE(flight.result.equilibrium);
}

TEST_CASE("states at events that creep change their range, those on a circle do not") {
  EventRanges slow, passing, turning;
  for (int k = 1; k <= 600; ++k) {
    slow.add(at_event(1.0 / k));
    passing.add(at_event(std::atan(0.01 * (k - 300))));  // past a ghost
    turning.add(at_event(std::cos(2.0 * k)));
    if (k < 256) continue;
    REQUIRE(slow.changing({false}));
    CHECK(slow.changing({false})->range == Approx(0.5).epsilon(0.05));
    CHECK(passing.changing({false}));
    CHECK_FALSE(turning.changing({false}));
    CHECK_FALSE(slow.changing({true}));
  }
}

TEST_CASE("series of falling intervals count where a longer one ends them, not where another event does") {
  const IndexVector impact{1, 1, 1}, limit{1, 1, 2};
  SeriesCounter counter;
  const auto fall = [&counter, &impact](int intervals) {
    double duration = 1.0;
    for (int k = 0; k <= intervals; ++k, duration *= 0.5) counter.add(impact, duration);
  };
  fall(7);
  counter.add(limit, 1e-3);  // all further impacts at once
  CHECK(counter.broken().empty());
  fall(4);  // too few
  fall(6);
  fall(9);
  counter.add(impact, 1.0);
  REQUIRE(counter.broken().count(impact) == 1);
  CHECK(counter.broken().at(impact).count == 2);
  CHECK(counter.broken().at(impact).longest == 9);
  // Hardly falling intervals are those of any motion.
  SeriesCounter slow;
  for (const double duration : {1.0, 0.99, 0.98, 0.97, 0.96, 0.95, 0.94, 1.0}) slow.add(impact, duration);
  CHECK(slow.broken().empty());
}

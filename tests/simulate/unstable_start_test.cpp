// Starts on or next to something unstable: its positive exponents are no chaos.
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "motion/simulated_problems.hpp"
#include "simulate/simulation_sampler.hpp"

using namespace tchat;
using namespace tchat::test;
using Eigen::VectorXd;

namespace {

/// Two oscillators of the frequencies 1 and PAR(3) and a state z, with r the radius of the first one:
///
///     r' = r g(r),   g = PAR(1) (1 - r^2),   z' = PAR(2) z - z^3,   the second one attracts to its unit circle
///
/// and a clock, whose event comes once per unit of time. PAR(1) > 0: r = 0 is unstable, r = 1 attracts; PAR(2) > 0:
/// z = 0 is unstable.
struct Slow {
  static constexpr int dimension = 6, parameters = 3, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T g = p[0] * (1.0 - x[0] * x[0] - x[1] * x[1]);
    f[0] = g * x[0] - x[1];
    f[1] = g * x[1] + x[0];
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[2] = growth * x[2] - p[2] * x[3];
    f[3] = growth * x[3] + p[2] * x[2];
    f[4] = p[1] * x[4] - x[4] * x[4] * x[4];
    f[5] = T(1.0);
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[5];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 5; ++i) g[i] = x[i];
    g[5] = x[5] - 1.0;
  }
};

/// r' = PAR(1) r (r^2 - 1) (4 - r^2), angle' = 1, z' = PAR(2) z - z^3: the circle r = 1 is unstable, r = 2 attracts;
/// with z = 0 both are unstable where PAR(2) > 0. Cut where x2 falls.
struct TwoCycles {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    const T square = x[0] * x[0] + x[1] * x[1];
    const T g = p[0] * (square - 1.0) * (4.0 - square);
    f[0] = g * x[0] - x[1];
    f[1] = g * x[1] + x[0];
    f[2] = p[1] * x[2] - x[2] * x[2] * x[2];
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

AttractorSample sampled(const HybridSystem& system, const VectorXd& start, const ParameterVector& par) {
  SamplerSetup setup;
  setup.request.modes = "1,1,1";
  setup.request.plan.transient_events = 300;
  setup.request.plan.events = 50;
  setup.starts = {start};
  setup.sides = {StartSide{}};
  setup.par = par;
  setup.recording.exponents = 2;
  setup.recording.states = Recording::States::all_events;
  return SimulationSampler(setup, system)({0, VectorXd(), 1, {}}, [] { return false; });
}

VectorXd slow_start(double x, double z) { return (VectorXd(6) << x, 0.0, 1.0, 0.0, z, 0.1).finished(); }

const double golden = 0.5 * (std::sqrt(5.0) - 1.0);

}  // namespace

TEST_CASE("a motion that leaves an unstable focus is not chaotic, however slowly", "[slow]") {
  for (const auto& [rate, distance] : {std::pair(3e-3, 1e-3), {0.02, 1e-12}}) {
    CAPTURE(rate, distance);
    const AttractorSample sample =
        sampled(system_of<Slow>(), slow_start(distance, 0.0), parameters({rate, -0.5, golden}));
    CHECK(sample.kind != AttractorKind::chaotic);
    CHECK(sample.kind != AttractorKind::periodic);
  }
}

TEST_CASE("a motion on or next to an unstable torus is not chaotic", "[slow]") {
  for (const double rate : {3e-3, 0.1})
    for (const double distance : {0.0, 1e-4}) {
      CAPTURE(rate, distance);
      const AttractorSample sample =
          sampled(system_of<Slow>(), slow_start(1.0, distance), parameters({0.5, rate, golden}));
      CHECK(sample.kind != AttractorKind::chaotic);
      CHECK(sample.kind != AttractorKind::periodic);
    }
  // Exactly on it the motion stays, and that is said.
  const AttractorSample kept = sampled(system_of<Slow>(), slow_start(1.0, 0.0), parameters({0.5, 0.1, golden}));
  CHECK(kept.kind == AttractorKind::none);
  CHECK(kept.message.find("undecided") == 0);
  CHECK(kept.exponents(0) == Approx(0.1).epsilon(1e-4));
}

TEST_CASE("a motion on or next to a torus with several unstable directions is not chaotic", "[slow]") {
  for (const double rate : {0.02, 0.2})
    for (const double distance : {0.0, 1e-6}) {
      CAPTURE(rate, distance);
      VectorXd start = slow_start(1.0, distance);
      start(2) = start(3) = 0.0;
      CHECK(sampled(system_of<Slow>(), start, parameters({0.5, rate, golden})).kind != AttractorKind::chaotic);
    }
}

TEST_CASE("a motion on or next to an unstable cycle is not chaotic, and settles on what attracts it if it gets there") {
  for (const double rate : {1e-4, 1e-3, 5e-3, 0.05})
    for (const double distance : {0.0, 1e-12, 1e-6, 1e-3}) {
      CAPTURE(rate, distance);
      const AttractorSample sample =
          sampled(system_of<TwoCycles>(), Eigen::Vector3d(1.0 + distance, 0.0, 0.0), parameters({rate, -0.1}));
      CHECK(sample.kind != AttractorKind::chaotic);
      CHECK(sample.kind != AttractorKind::quasi_periodic);
      if (sample.kind == AttractorKind::periodic) CHECK(sample.sizes(0) == Approx(4.0).epsilon(1e-3));
      if (rate >= 5e-3 && distance >= 1e-6) CHECK(sample.kind == AttractorKind::periodic);
    }
}

TEST_CASE("a motion on or next to a saddle cycle is not chaotic") {
  for (const double rate : {1e-3, 0.01})
    for (const double distance : {0.0, 1e-12, 1e-3}) {
      CAPTURE(rate, distance);
      const AttractorSample sample =
          sampled(system_of<TwoCycles>(), Eigen::Vector3d(2.0, 0.0, distance), parameters({0.1, rate}));
      CHECK(sample.kind != AttractorKind::chaotic);
      CHECK(sample.kind != AttractorKind::quasi_periodic);
      // On the saddle z = 0 the motion stays; beside it z goes to the root of PAR(2).
      if (distance == 0.0) CHECK(sample.kind == AttractorKind::none);
      if (sample.kind == AttractorKind::periodic) CHECK(sample.sections(2, 0) == Approx(std::sqrt(rate)).epsilon(1e-4));
    }
}

TEST_CASE("a start on an unstable orbit has no attractor, and the reason names its multiplier") {
  const AttractorSample sample =
      sampled(system_of<TwoCycles>(), Eigen::Vector3d(2.0, 0.0, 0.0), parameters({0.1, 0.01}));
  CHECK(sample.kind == AttractorKind::none);
  CAPTURE(sample.message);
  // exp(0.01 T), T = 2 pi
  CHECK(sample.message.find("1.064847") != std::string::npos);
}

TEST_CASE("chaos remains chaos: the logistic map of a clock, from its edge on") {
  for (const double a : {3.58, 3.6, 3.65, 3.7, 3.8, 3.9, 4.0}) {
    CAPTURE(a);
    CHECK(sampled(system_of<LogisticClock>(), Eigen::Vector3d(0.0, 0.3, 0.0), parameters({a})).kind ==
          AttractorKind::chaotic);
  }
  // Next to its unstable fixed point 1 - 1 / a, too.
  CHECK(sampled(system_of<LogisticClock>(), Eigen::Vector3d(0.0, 0.75 + 1e-9, 0.0), parameters({4.0})).kind ==
        AttractorKind::chaotic);
}

/// Small problems whose motion is known in closed form, and simulations of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "motion/settle.hpp"
#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

using IndexVectors = std::vector<std::array<int, 3>>;

/// A ball on a floor: x = (height, velocity), PAR = (g, r). Events: 1 the floor, 2 the top of the flight.
struct BouncingBall {
  static constexpr int dimension = 2, parameters = 2, fields = 1, events = 2, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1], f[1] = -p[0];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? T(-p[1] * x[1]) : x[1];
  }
};

/// x'' = -w^2 x between walls at x = 1 (event 1) and y >= 0 (event 2), y'' = 0; x = (x, x', y, y'), PAR = (w, r).
/// Event 3 is the maximum of x.
struct TwoWalls {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 3, jumps = 3;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1], f[1] = -p[0] * p[0] * x[0];
    f[2] = x[3], f[3] = T(0.0);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? T(1.0 - x[0]) : j == 2 ? x[2] : x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -p[1] * x[1];
    if (k == 2) g[3] = -p[1] * x[3];
  }
};

/// The logistic map c -> a c (1 - c), once per unit of time; s grows for ever and matters to nothing.
/// x = (clock, c, s), PAR(1) = a.
struct LogisticClock {
  static constexpr int dimension = 3, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T*, T* f) const {
    f[0] = T(1.0), f[1] = T(0.0), f[2] = x[1];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }
  template <class T>
  void jump(int, const T* x, const T* p, T* g) const {
    g[0] = x[0] - 1.0, g[1] = p[0] * x[1] * (1.0 - x[1]), g[2] = x[2];
  }
};

inline SimulationSettings settings_for_tests(double tolerance = 1e-12,
                                             IntegrationMethod method = IntegrationMethod::adams) {
  SimulationSettings settings;
  settings.flow.relative_tolerance = tolerance;
  settings.flow.absolute_tolerance = 0.01 * tolerance;
  settings.flow.max_duration = 1000.0;
  settings.flow.method = method;
  return settings;
}

/// Always the same set of index vectors.
template <class Problem>
ModeRule always(std::vector<IndexVector> index_vectors) {
  return ModeRule(system_of<Problem>(), std::vector<Mode>{Mode{std::move(index_vectors), {}}});
}

/// With the last turn, where the motion repeats itself.
struct Simulated {
  SimulationResult result;
  std::vector<SimulatedSegment> segments;
};

inline Simulated simulate(const ModeRule& rule, const Eigen::VectorXd& x, const ParameterVector& par,
                          const SimulationPlan& plan, SimulationSettings settings = settings_for_tests()) {
  HybridSimulation simulation(rule, x, par, settings);
  Simulated all;
  AttractorSearch search(plan.max_period, plan.recognition, settings);
  all.result = run_simulation(
      simulation, plan, [&](const SimulatedSegment& s) { all.segments.push_back(s); }, search);
  if (plan.has_length()) search.conclude(simulation);
  if (all.result.goes_on() && search.orbit()) all.result.turn.segments = search.orbit()->turn;
  return all;
}

inline SimulationPlan so_many_events(long events) { return plan_of_events(events); }

inline SimulationPlan so_long(double time) {
  SimulationPlan plan;
  plan.time = time;
  return plan;
}

}  // namespace tchat::test

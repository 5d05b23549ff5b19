/// Problems whose Lyapunov exponents are known.
#pragma once

#include "motion/lyapunov_exponents.hpp"
#include "motion/simulated_problems.hpp"

namespace tchat::test {

/// The Lorenz system, PAR = (sigma, rho, beta); event 1 falls where z = 27 is crossed downwards.
struct Lorenz {
  static constexpr int dimension = 3, parameters = 3, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = p[0] * (x[1] - x[0]);
    f[1] = x[0] * (p[1] - x[2]) - x[1];
    f[2] = x[0] * x[1] - p[2] * x[2];
  }
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[2] - 27.0;
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
  }
};

inline ParameterVector lorenz_parameters() { return parameters({10.0, 28.0, 8.0 / 3.0}); }

/// x' = diag(PAR(1), PAR(2), PAR(3)) x; event 1 never falls.
struct Diagonal {
  static constexpr int dimension = 3, parameters = 3, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    for (int i = 0; i < 3; ++i) f[i] = p[i] * x[i];
  }
  template <class T>
  T event(int, const T*, const T*) const {
    return T(1.0);
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
  }
};

/// The same with an event whose surface goes through the equilibrium.
struct CutDiagonal : Diagonal {
  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0] - x[1];
  }
};

/// Two planar oscillators that attract to the unit circle, of frequencies PAR(1) and PAR(2), at the rate 2 each; event
/// 1: the first goes down through y = 0.
struct TwoCircles {
  static constexpr int dimension = 4, parameters = 2, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    for (int c = 0; c < 2; ++c) {
      const T growth = 1.0 - x[2 * c] * x[2 * c] - x[2 * c + 1] * x[2 * c + 1];
      f[2 * c] = growth * x[2 * c] - p[c] * x[2 * c + 1];
      f[2 * c + 1] = growth * x[2 * c + 1] + p[c] * x[2 * c];
    }
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

/// A block on a belt of velocity PAR(1) that sticks to it: x = (q, v), slip (field 1) v' = -q - PAR(2) v, stick
/// (field 2) v' = 0, q' = v. Slip ends where v rises to the belt's velocity (event 1: belt - v), stick
/// where q exceeds 1 (event 2: 1 - q), with a loss of velocity (jump 2).
struct Belt {
  static constexpr int dimension = 2, parameters = 2, fields = 2, events = 2, jumps = 2;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = i == 1 ? T(-x[0] - p[1] * x[1]) : T(0.0);
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? p[0] - x[1] : 1.0 - x[0];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? x[1] : T(0.5 * p[0]);
  }
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[0] == 1) return {{2, 2, 2}};
    return {{1, 1, 1}};
  }
};

struct Measured {
  LyapunovSpectrum spectrum;
  SimulatedSegment last;
};

/// Exponents of `events` events after so many others; with the frame riding along, or segments integrated again.
inline Measured measure(const ModeRule& rule, const Eigen::VectorXd& x0, const ParameterVector& par, long transient,
                        long events, LyapunovSettings exponents = {}, bool rides_along = true,
                        SimulationSettings settings = settings_for_tests(1e-10), double end_time = 1e300) {
  settings.samples = 0;
  exponents.flow = settings.flow;
  LyapunovAccumulator accumulator(rule.system(), par, exponents);
  if (rides_along) accumulator.attach(settings);
  HybridSimulation simulation(rule, x0, par, settings);
  Measured measured;
  for (long k = 0; k < transient; ++k) measured.last = simulation.next(end_time);
  if (rides_along) accumulator.begin();
  for (long k = 0; k < events; ++k) {
    measured.last = simulation.next(end_time);
    accumulator.pass(measured.last);
    if (measured.last.ended_by != SegmentEnd::event) break;
  }
  measured.spectrum = accumulator.spectrum();
  return measured;
}

}  // namespace tchat::test

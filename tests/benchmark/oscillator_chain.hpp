/// A chain of oscillators whose first mass is forced and hits a wall: the linear impact oscillator with any number of
/// states. Also the source of a plugin.
///
///     q_i'' + 2 zeta q_i' + q_i = kappa (q_{i-1} - q_i) + kappa (q_{i+1} - q_i) + [i = 1] alpha y2,   q_1 <= 1
///
/// with the terms of the neighbours that there are; states q_1, q_1', q_2, q_2', ..., y1, y2.
#pragma once

#include <tchat/problem.hpp>

namespace tchat::benchmark {

template <int Masses>
struct OscillatorChain {
  static constexpr int dimension = 2 * Masses + 2, parameters = 5;
  static constexpr int fields = 1, events = 1, jumps = 1;
  static constexpr const char* parameter_names[] = {"alpha", "omega", "zeta", "r", "kappa"};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T &alpha = par[0], &omega = par[1], &zeta = par[2], &kappa = par[4];
    const T* const y = x + 2 * Masses;
    const T radius2 = y[0] * y[0] + y[1] * y[1];
    for (int i = 0; i < Masses; ++i) {
      const T* const q = x + 2 * i;
      f[2 * i] = q[1];
      f[2 * i + 1] = -q[0] - 2.0 * zeta * q[1];
      if (i > 0) f[2 * i + 1] += kappa * (q[-2] - q[0]);
      if (i + 1 < Masses) f[2 * i + 1] += kappa * (q[2] - q[0]);
    }
    f[1] += alpha * y[1];
    f[2 * Masses] = y[0] + omega * y[1] - y[0] * radius2;
    f[2 * Masses + 1] = y[1] - omega * y[0] - y[1] * radius2;
  }

  template <class T>
  T event(int, const T* x, const T*) const {
    return 1.0 - x[0];
  }

  template <class T>
  void jump(int, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    g[1] = -par[3] * x[1];
  }
};

}  // namespace tchat::benchmark

/// A ring of n / 2 oscillators, each drawn to its neighbours,
///
///     z_j' = (mu + i (1 + b |z_j|^2)) z_j - |z_j|^2 z_j + k (z_{j-1} - 2 z_j + z_{j+1}),
///
/// of any even dimension, with fields that are polynomials of third degree. All in step they go round the circle
/// |z_j|^2 = mu in the period 2 pi / (1 + b mu).
#pragma once

#include "support/test_system.hpp"

namespace tchat::test {

template <int N>
struct OscillatorRing {
  static constexpr int dimension = N, parameters = 3, fields = 1, events = 1, jumps = 2;

  template <class T>
  void field(int, const T* z, const T* p, T* f) const {
    constexpr int count = N / 2;
    const T &mu = p[0], &b = p[1], &k = p[2];
    for (int j = 0; j < count; ++j) {
      const int left = (j + count - 1) % count, right = (j + 1) % count;
      const T &x = z[2 * j], &y = z[2 * j + 1];
      const T size = x * x + y * y;
      const T growth = mu - size, frequency = 1.0 + b * size;
      f[2 * j] = growth * x - frequency * y + k * (z[2 * left] - 2.0 * x + z[2 * right]);
      f[2 * j + 1] = growth * y + frequency * x + k * (z[2 * left + 1] - 2.0 * y + z[2 * right + 1]);
    }
  }
  template <class T>
  T event(int, const T* z, const T*) const {
    return 0.0 - z[1];
  }
  template <class T>
  void jump(int k, const T* z, const T*, T* g) const {
    for (int i = 0; i < N; ++i) g[i] = z[i];
    if (k == 1) g[0] = 0.9 * z[0];
  }
};

}  // namespace tchat::test

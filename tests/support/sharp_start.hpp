/// An orbit of one sharp segment and a smooth one: x is thrown away from y by 1 and falls back to it at the rate k,
/// which lifts y, while both decay; from the level a both grow towards 2 until x reaches the level b.
///
///     x' = k (y - x) - x + k (x - y)^2 / 2, y' = k (x - y)^2 / 2 - y  until x = a;
///     x' = 2 - x, y' = 2 - y  until x = b;    x := x + d, y := y - e
///
/// PAR: k, a, b, d, e. Found by shooting, the independent reference.
#pragma once

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

struct SharpStart {
  static constexpr int dimension = 2, parameters = 5, fields = 2, events = 2, jumps = 2;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = 2.0 - x[0], f[1] = 2.0 - x[1];
    if (i == 2) return;
    const T offset = x[0] - x[1];
    f[1] = 0.5 * p[0] * offset * offset - x[1];
    f[0] = 0.5 * p[0] * offset * offset - p[0] * offset - x[0];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    if (j == 1) return x[0] - p[1];
    return p[2] - x[0];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    g[0] = x[0], g[1] = x[1];
    if (k == 2) g[0] = x[0] + p[3], g[1] = x[1] - p[4];
  }

  static ParameterVector par(double rate) { return test::parameters({rate, 0.5, 1.0, 1.0, 0.02}); }
  static Signature signature() { return {{1, 1, 1}, {2, 2, 2}}; }
  static PeriodicOrbit orbit(double rate) {
    ShootingOptions options;
    options.tolerance = 1e-13;
    return shoot(system_of<SharpStart>(), signature(), Eigen::Vector2d(2.0, 1.0), par(rate), options);
  }
  static Orbit sampled(const PeriodicOrbit& orbit, double rate, int intervals, int collocation) {
    return sampled_orbit(pieces_of(system_of<SharpStart>(), signature(), orbit.map, par(rate)), 2, intervals,
                         collocation, par(rate));
  }
};

}  // namespace tchat::test

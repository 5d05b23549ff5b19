/// A nonlinear hybrid system of three different fields, event functions and jumps in three dimensions, with a periodic
/// orbit {(1,1,1), (2,2,2), (3,3,3)}: x1 charges to about 1, discharges to about 0.4, rests until about 0.2.
/// PAR(1) scales the coupling of the other two states.
#pragma once

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

struct ThreeModes {
  static constexpr int dimension = 3, parameters = 2, fields = 3, events = 3, jumps = 3;

  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    using std::cos, std::sin, std::exp;
    if (i == 1) {
      f[0] = 1.5 - x[0] + 0.3 * x[1] * x[1];
      f[1] = -0.2 * x[1] + p[0] * cos(x[0]) - 0.1 * x[2];
      f[2] = -0.1 * x[2] + x[0] * x[1];
    } else if (i == 2) {
      f[0] = -x[0] - 0.1 * x[1] - 0.1 * x[2] * x[2];
      f[1] = p[0] * x[2] - 0.3 * x[1];
      f[2] = -p[0] * x[1] - 0.2 * x[2] * exp(x[0]);
    } else {
      f[0] = -0.4 * x[0] + 0.05 * sin(x[1] + x[2]) - 0.1;
      f[1] = -0.1 * x[1] + x[0] * x[2];
      f[2] = -0.5 * x[2] + p[1] * x[0] / (1.0 + x[1] * x[1]);
    }
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return 1.0 - x[0] + 0.1 * x[2];
    if (j == 2) return x[0] - 0.4 - 0.05 * x[1];
    return x[0] - 0.2 - 0.1 * x[1] * x[2];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    using std::sin;
    g[0] = x[0], g[1] = x[1], g[2] = x[2];
    if (k == 1) g[1] = 0.8 * x[1] + 0.2 * x[0] * x[0];
    if (k == 2) g[1] = x[1] - 0.1 * sin(x[2]), g[2] = p[1] * x[2] + 0.3 * x[1];
    if (k == 3) g[2] = x[2] + 0.1 - 0.4 * x[0] * x[1];
  }

  static Signature signature() { return {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}; }
  static ParameterVector par() { return test::parameters({0.4, 0.9}); }

  static PeriodicOrbit orbit(const ParameterVector& par) {
    Eigen::VectorXd x = Eigen::Vector3d(0.2, 0.3, 0.2);
    for (int turn = 0; turn < 12; ++turn) {
      const ReturnMap map = return_map(system_of<ThreeModes>(), signature(), x, par);
      if (!map.ok) break;
      x = map.end;
    }
    return shoot(system_of<ThreeModes>(), signature(), x, par);
  }
};

}  // namespace tchat::test

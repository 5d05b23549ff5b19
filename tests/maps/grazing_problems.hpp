/// Problems whose discontinuity maps are known, from chapters 3 and 4 of the dissertation and in closed form.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "model/parameter_vector.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

/// (3.1), (3.2): PAR = (mu, d, r).
struct PlanarOscillator {
  static constexpr int dimension = 2, parameters = 3, fields = 1, events = 2, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = -x[0] - x[1] * (x[0] * x[0] - p[0]);
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(p[1] - x[0]) : x[1];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? T(-p[2] * x[1]) : x[1];
  }
};

/// (3.15)-(3.17), the phase an angle: PAR = (mu, c, A, omega, r). Event 2: phase 0.
struct ForcedVanDerPol {
  static constexpr int dimension = 3, parameters = 5, fields = 1, events = 2, jumps = 2;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    using std::cos;
    f[0] = x[1];
    f[1] = -x[0] - p[1] * x[1] * (x[0] * x[0] - 1.0) + p[2] * cos(x[2]);
    f[2] = p[3];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(p[0] - x[0]) : T(-x[2]);
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
    if (k == 1) g[1] = -p[4] * x[1];
  }
};

/// (4.7)-(4.9), the phase an angle: PAR = (mu, m, r, A, omega). With A = 0 and without the phase (4.1), (4.2).
struct ForcedThreeDimensional {
  static constexpr int dimension = 4, parameters = 5, fields = 1, events = 2, jumps = 2;
  template <class T>
  static T velocity(const T* x, const T* p) {
    return (p[1] - x[2]) * x[0] - x[1];
  }
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    using std::cos;
    f[0] = velocity(x, p);
    f[1] = p[1] * x[1] + x[0] + p[3] * cos(x[3]);
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
    f[3] = p[4];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(x[0] - p[0]) : T(-velocity(x, p));
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = x[1] + (1.0 + p[2]) * velocity(x, p);
  }
};

/// A mass pushed off a floor by a constant force, and a clock: x = (q, v, s), q'' = a, s' = omega, PAR = (a, r, omega,
/// floor). Event 1: q = floor; 2: s. Jump 2 is the identity, 3 moves the clock at contact, 4 is an impact after which
/// the clock is late by the velocity.
struct PushedMass {
  static constexpr int dimension = 3, parameters = 4, fields = 1, events = 2, jumps = 4;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1], f[1] = p[0], f[2] = p[2];
  }
  template <class T>
  T event(int j, const T* x, const T* p) const {
    return j == 1 ? T(x[0] - p[3]) : x[2];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
    if (k == 1 || k == 4) g[1] = -p[1] * x[1];
    if (k == 3) g[2] = x[2] + 1.0;
    if (k == 4) g[2] = x[2] + x[1];
  }
};

/// The pushed mass on a support that slips after an impact: x = (q, v, s, u), PAR = (a, r, omega, c, b). An impact
/// gives the support the velocity u = -c v; field 2, the slip, has u' = -1 and q'' = b, until u = 0 (event 2).
struct SlippingSupport {
  static constexpr int dimension = 4, parameters = 5, fields = 2, events = 2, jumps = 2;
  template <class T>
  void field(int i, const T* x, const T* p, T* f) const {
    f[0] = x[1], f[1] = i == 1 ? p[0] : p[4], f[2] = p[2], f[3] = T(i == 1 ? 0.0 : -1.0);
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : x[3];
  }
  template <class T>
  void jump(int k, const T* x, const T* p, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -p[1] * x[1], g[3] = x[3] - p[3] * x[1];
  }
};

inline ParameterVector parameters(std::initializer_list<double> values) {
  ParameterVector par{ParameterLayout()};
  int k = 0;
  for (const double value : values) par(k++) = value;
  return par;
}

}  // namespace tchat::test

/// Van der Pol's oscillator x1'' - mu (1 - x1^2) x1' + x1 = 0: a smooth limit cycle on the section x2 = 0 (maximum of
/// x1), found by shooting as the independent reference.
#pragma once

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

struct VanDerPol {
  static constexpr int dimension = 2, parameters = 1, fields = 1, events = 1, jumps = 1;
  template <class T>
  void field(int, const T* x, const T* p, T* f) const {
    f[0] = x[1];
    f[1] = p[0] * (1.0 - x[0] * x[0]) * x[1] - x[0];
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

inline PeriodicOrbit van_der_pol_cycle(double mu) {
  ShootingOptions options;
  options.tolerance = 1e-12;
  return shoot(system_of<VanDerPol>(), {{1, 1, 1}}, Eigen::Vector2d(2.01, 0.0), parameters({mu}), options);
}

inline std::vector<Piece> van_der_pol_pieces(const PeriodicOrbit& cycle, double mu) {
  return pieces_of(system_of<VanDerPol>(), {{1, 1, 1}}, cycle.map, parameters({mu}));
}

}  // namespace tchat::test

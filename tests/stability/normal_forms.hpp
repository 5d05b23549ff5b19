/// Normal forms of bifurcations beside a rotation: the unit circle x = (cos theta, sin theta), attracting with rate -2,
/// theta' = 1, and a third state
///
///     field 1 (pitchfork) z' = mu z - z^3,   2 (fold) z' = mu - z^2,   3 (transcritical) z' = mu z - z^2.
///
/// Periodic orbits are the equilibria z, T = 2 pi; multipliers exp(-4 pi), 0 and exp(2 pi dz'/dz), the last one negated
/// by the jump 2, z -> -z (where z = 0). Event 1 is the section y = 0 at theta = pi, event 2 the wall p - x - z,
/// touched at theta = 0 when p = 1 + z. PAR(1) = mu, PAR(2) = p.
#pragma once

#include "support/sampled_orbit.hpp"
#include "support/test_system.hpp"

namespace tchat::test {

struct NormalForms {
  static constexpr int dimension = 3, parameters = 2, fields = 3, events = 2, jumps = 2;

  template <class T>
  void field(int i, const T* u, const T* p, T* f) const {
    const T growth = 1.0 - u[0] * u[0] - u[1] * u[1];
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
    const T& z = u[2];
    if (i == 1) f[2] = p[0] * z - z * z * z;
    if (i == 2) f[2] = p[0] - z * z;
    if (i == 3) f[2] = p[0] * z - z * z;
  }
  template <class T>
  T event(int j, const T* u, const T* p) const {
    if (j == 1) return u[1];
    return p[1] - u[0] - u[2];
  }
  template <class T>
  void jump(int k, const T* u, const T*, T* g) const {
    g[0] = u[0], g[1] = u[1];
    g[2] = k == 2 ? T(-u[2]) : u[2];
  }

  /// The orbit of constant z that begins at angle theta0.
  static Orbit orbit(double theta0, double z, double mu, double p, int intervals = 20, int collocation = 4) {
    const auto state = [=](double t) {
      Eigen::VectorXd u(3);
      u << std::cos(theta0 + t), std::sin(theta0 + t), z;
      return u;
    };
    return sampled_orbit({{2 * pi, state}}, 3, intervals, collocation, parameters_of(mu, p));
  }
  static ParameterVector parameters_of(double mu, double p) { return test::parameters({mu, p}); }
};

}  // namespace tchat::test

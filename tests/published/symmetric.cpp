/// A circle of radius R, R^2 = 1 + c z^2, run through with angular velocity 1, beside z' = mu z - z^3: symmetric in z.
/// The wall e z + x <= p is not. Orbits of constant z = 0 and, for mu > 0, z = +-sqrt(mu), of period 2 pi, with the
/// multipliers exp(2 pi mu) and exp(-4 pi mu) of z; they graze where p = R + e z.
#include <tchat/problem.hpp>

struct Symmetric {
  static constexpr int dimension = 3, parameters = 2, fields = 1, events = 1, jumps = 2;
  static constexpr double c = 0.3, e = 0.2;
  static constexpr const char* state_names[] = {"x", "y", "z"};
  static constexpr const char* parameter_names[] = {"mu", "p"};
  static constexpr const char* event_names[] = {"wall"};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    const T growth = 1.0 + c * u[2] * u[2] - u[0] * u[0] - u[1] * u[1];
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
    f[2] = par[0] * u[2] - u[2] * u[2] * u[2];
  }
  template <class T>
  T event(int, const T* u, const T* par) const {
    return par[1] - u[0] - e * u[2];
  }
  /// 1: what an impact would do (never used here), 2: identity.
  template <class T>
  void jump(int k, const T* u, const T*, T* g) const {
    g[0] = u[0];
    g[1] = k == 1 ? T(-0.8 * u[1]) : u[1];
    g[2] = u[2];
  }
};

TCHAT_PROBLEM(Symmetric)

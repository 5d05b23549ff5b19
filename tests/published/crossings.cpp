/// The unit circle, run through with angular velocity 1, beside a third state, 1/2 + z, where equilibria z cross at
/// branch points of our choice:
///
///     field 1   z' = (p1^2 + p2^2 - 1/4) z - z^3       pitchforks on a circle of (p1, p2), for every p3
///     field 2   z' = p2 - p3 + (p1 - p2^2) z - z^2     a branch point in p1 at p1 = p2^2, z = 0 where p2 = p3 only
///     field 3   z' = (p1 - p2^2) z - z^2               transcritical points at p1 = p2^2
#include <tchat/problem.hpp>

struct Crossings {
  static constexpr int dimension = 3, parameters = 3, fields = 3, events = 1, jumps = 1;
  static constexpr double height = 0.5;
  static constexpr const char* state_names[] = {"x", "y", "height"};
  static constexpr const char* parameter_names[] = {"p1", "p2", "p3"};

  template <class T>
  void field(int i, const T* u, const T* par, T* f) const {
    const T growth = 1.0 - u[0] * u[0] - u[1] * u[1];
    const T &p1 = par[0], &p2 = par[1], &p3 = par[2];
    const T z = u[2] - height;
    f[0] = u[0] * growth - u[1];
    f[1] = u[1] * growth + u[0];
    if (i == 1) f[2] = (p1 * p1 + p2 * p2 - 0.25) * z - z * z * z;
    if (i == 2) f[2] = p2 - p3 + (p1 - p2 * p2) * z - z * z;
    if (i == 3) f[2] = (p1 - p2 * p2) * z - z * z;
  }
  template <class T>
  T event(int, const T* u, const T*) const {
    return u[1];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    for (int k = 0; k < 3; ++k) g[k] = u[k];
  }
};

TCHAT_PROBLEM(Crossings)

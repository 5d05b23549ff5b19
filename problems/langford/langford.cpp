// Langford's three-dimensional system, a smooth problem with a torus bifurcation:
//
//     x' = (z - b) x - d y,   y' = d x + (z - b) y,   z' = c + a z - z^3 / 3 - (x^2 + y^2) (1 + e z) + f z x^3.
//
// With f = 0 the rotation is a symmetry: in the radius r the periodic orbit is the equilibrium z = b,
// r^2 = (c + a b - b^3 / 3) / (1 + e b), and its torus bifurcation the Hopf bifurcation of (r, z) at
// a = b^2 + e r^2, with angle 2 pi sqrt(2 r^2 (1 + e b)) / d. The Poincare section is y = 0, crossed downwards.
#include <tchat/problem.hpp>

struct Langford {
  static constexpr int dimension = 3, parameters = 6;
  static constexpr int fields = 1, events = 1, jumps = 1;

  static constexpr const char* state_names[] = {"x", "y", "z"};
  static constexpr const char* parameter_names[] = {"a", "b", "c", "d", "e", "f"};
  static constexpr const char* event_names[] = {"section y = 0"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {0.5, 0.7, 0.6, 3.5, 0.25, 0.0};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    const T &x = u[0], &y = u[1], &z = u[2];
    const T &a = par[0], &b = par[1], &c = par[2], &d = par[3], &e = par[4];
    f[0] = (z - b) * x - d * y;
    f[1] = d * x + (z - b) * y;
    f[2] = c + a * z - z * z * z / 3.0 - (x * x + y * y) * (1.0 + e * z) + par[5] * z * x * x * x;
  }
  template <class T>
  T event(int, const T* u, const T*) const {
    return u[1];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = u[i];
  }
};

TCHAT_PROBLEM(Langford)

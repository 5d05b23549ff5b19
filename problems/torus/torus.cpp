// A torus in closed form: a forced oscillator in the plane,
//
//     x' = -Omega y + x (1 + r (cos omega t - 1)),   y' = Omega x + y (1 + r (cos omega t - 1)),   r^2 = x^2 + y^2,
//
// whose angle turns with Omega and whose radius is linear in 1 / r: (1 / r)' = -1 / r + 1 - cos omega t. It is made
// autonomous by s = sin omega t, c = cos omega t, the attracting limit cycle of a second oscillator. The torus is
//
//     r = (1 + omega^2) / (1 + omega^2 - c - omega s).
//
// The section is y = 0 at x < 0, and x = mu is a wall that is not there unless the torus reaches it.
#include <tchat/problem.hpp>

struct PlanarTorus {
  static constexpr int dimension = 4, parameters = 3;
  static constexpr int fields = 1, events = 2, jumps = 1;

  static constexpr const char* state_names[] = {"x", "y", "s", "c"};
  static constexpr const char* parameter_names[] = {"omega", "Omega", "mu"};
  static constexpr const char* event_names[] = {"section y = 0", "wall"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {1.0, 1.618033988749895, 5.0};
  static constexpr double initial_state[] = {-1.0, 0.0, 0.0, 1.0};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    const T &x = u[0], &y = u[1], &s = u[2], &c = u[3], &omega = par[0], &Omega = par[1];
    const T growth = 1.0 + sqrt(x * x + y * y) * (c - 1.0);
    const T away = 1.0 - s * s - c * c;
    f[0] = -Omega * y + x * growth;
    f[1] = Omega * x + y * growth;
    f[2] = omega * c + s * away;
    f[3] = -omega * s + c * away;
  }
  template <class T>
  T event(int j, const T* u, const T* par) const {
    if (j == 1) return u[1];
    return par[2] - u[0];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = u[i];
  }
};

TCHAT_PROBLEM(PlanarTorus)

// Duffing's oscillator with a hardening spring, forced harmonically, a smooth problem with a symmetry:
//
//     x'' + d x' + x + x^3 = A cos(omega t)
//
// Turned round half a period later, (x, v, sine, cosine) -> -(x, v, sine, cosine), it is the same. The forcing is two
// states, sine and cosine, attracted to the unit circle. The Poincare section is sine = 0, crossed downwards.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Duffing {
  static constexpr int dimension = 4, parameters = 3;
  static constexpr int fields = 1, events = 1, jumps = 1;

  static constexpr const char* state_names[] = {"x", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"omega", "d", "A"};
  static constexpr const char* event_names[] = {"half a period"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {3.0, 0.2, 3.0};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 1.0};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    const T growth = 1.0 - u[2] * u[2] - u[3] * u[3];
    f[0] = u[1];
    f[1] = par[2] * u[3] - par[1] * u[1] - u[0] - u[0] * u[0] * u[0];
    f[2] = growth * u[2] + par[0] * u[3];
    f[3] = growth * u[3] - par[0] * u[2];
  }

  template <class T>
  T event(int, const T* u, const T*) const {
    return u[2];
  }

  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = u[i];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}}; }
};

TCHAT_PROBLEM(Duffing)

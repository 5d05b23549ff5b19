/// A driven mass on a spring between two walls, q'' + 2 zeta q' + q = F cos(omega t), |q| <= 1, velocity -> -r velocity
/// at a wall. Turned round, q -> -q half a period later, it is the same: orbits with one impact at either wall are
/// symmetric, with T_1 = T_2 = pi / omega, until they lose their symmetry at a branch point.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct TwoSided {
  static constexpr int dimension = 4, parameters = 4, fields = 1, events = 2, jumps = 1;
  static constexpr const char* state_names[] = {"q", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"F", "omega", "zeta", "r"};
  static constexpr double initial_parameters[] = {3.0, 2.1, 0.05, 0.8};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 1.0};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = par[0] * x[3] - 2.0 * par[2] * x[1] - x[0];
    f[2] = growth * x[2] + par[1] * x[3];
    f[3] = growth * x[3] - par[1] * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? T(1.0 - x[0]) : T(1.0 + x[0]);
  }
  template <class T>
  void jump(int, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    g[1] = -par[3] * x[1];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 1}}; }
};

TCHAT_PROBLEM(TwoSided)

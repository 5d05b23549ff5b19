// A slender rigid block that rocks about its two corners on a ground which shakes harmonically (Hogan 1989):
//
//     x'' = x - sgn(x) + beta cos(omega t),   velocity -> r velocity at x = 0
//
// x is the angle of rotation in units of the angle at which the block topples by itself, time that of its fall. The
// forcing is made autonomous by (sine, cosine), the attracting limit cycle of a planar oscillator.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct RockingBlock {
  static constexpr int dimension = 4, parameters = 3;
  static constexpr int fields = 2, events = 2, jumps = 3;

  static constexpr const char* state_names[] = {"x", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"beta", "omega", "r"};
  static constexpr const char* field_names[] = {"right corner", "left corner"};
  static constexpr const char* event_names[] = {"upright from the right", "upright from the left"};
  static constexpr const char* jump_names[] = {"impact", "impact in the mirror", "identity"};
  static constexpr double initial_parameters[] = {1.0, 2.0, 0.925};
  static constexpr double initial_state[] = {0.6, 0.0, 0.0, -1.0};

  static constexpr int user_values = 1;
  static constexpr const char* user_value_names[] = {"v0"};

  template <class T>
  void field(int k, const T* x, const T* par, T* f) const {
    const T &beta = par[0], &omega = par[1];
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = x[0] + beta * x[3] + (k == 1 ? -1.0 : 1.0);
    f[2] = growth * x[2] + omega * x[3];
    f[3] = growth * x[3] - omega * x[2];
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : -x[0];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k < 3) g[1] = par[2] * x[1];
    if (k == 2) g[1] = -g[1], g[2] = -x[2], g[3] = -x[3];
  }

  /// From one corner to the other; a start at x = 0 goes where its velocity leads.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double*) const {
    if (from[0] == 2 || (from[0] == 0 && x[0] + 1e-9 * x[1] > 0.0)) return {{1, 1, 1}};
    return {{2, 2, 1}};
  }

  /// Velocity after the last impact.
  void user_value(const double* x, const double*, double* out) const { out[0] = x[1]; }
};

TCHAT_PROBLEM(RockingBlock)

// A ball that bounces on a table which moves up and down harmonically; lengths in g / omega^2, times in 1 / omega:
//
//     height'' = -1,   table = Gamma sin(t),   at height = table: v -> -r v + (1 + r) w
//
// with v and w the velocities of ball and table, and Gamma = A omega^2 / g. The table's motion is a state too: (table,
// w) is attracted to the circle of radius Gamma. While it is not on it the table's velocity is another one than w.
#include <array>
#include <cmath>
#include <tchat/problem.hpp>
#include <vector>

struct BouncingBall {
  static constexpr int dimension = 4, parameters = 2;
  static constexpr int fields = 1, events = 1, jumps = 2;

  static constexpr const char* state_names[] = {"height", "velocity", "table", "w"};
  static constexpr const char* parameter_names[] = {"Gamma", "r"};
  static constexpr const char* field_names[] = {"flight"};
  static constexpr const char* event_names[] = {"table"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr double initial_parameters[] = {1.3, 0.5};
  static constexpr double initial_state[] = {0.0, 3.0, 0.0, 1.3};

  static constexpr int user_values = 1;
  static constexpr const char* user_value_names[] = {"phase"};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = growth_of(x, par);
    f[0] = x[1];
    f[1] = T(-1.0);
    f[2] = growth * x[2] + x[3];
    f[3] = growth * x[3] - x[2];
  }

  template <class T>
  T event(int, const T* x, const T*) const {
    return x[0] - x[2];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[1] * x[1] + (1.0 + par[1]) * (growth_of(x, par) * x[2] + x[3]);
  }

  /// Of table and w; zero on the circle.
  template <class T>
  static T growth_of(const T* x, const T* par) {
    return 1.0 - (x[2] * x[2] + x[3] * x[3]) / (par[0] * par[0]);
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}}; }

  /// The table's phase at the impact that ends the orbit.
  void user_value(const double* x, const double*, double* out) const { out[0] = std::atan2(x[2], x[3]); }
};

TCHAT_PROBLEM(BouncingBall)

// A rod in pieces beside a stop: a chain of masses and springs, all 1, fixed at one end. Its last mass meets a stop at
// u_N = 1, which returns its velocity without loss:
//
//     u_i'' = s_{i+1} - s_i,   s_i = (u_i - u_{i-1}) + d (u_i' - u_{i-1}'),   u_0 = 0,   s_{N+1} = f (1 - u_N^2) u_N'
//
// with a damper d beside each spring, and a force f that drives the tip. Without both the energy is conserved. Periodic
// orbits are then families: the modes of the chain, and the contact modes that follow from their first touch.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct BeamStop {
  static constexpr int masses = 5;
  static constexpr int dimension = 2 * masses, parameters = 2;
  static constexpr int fields = 1, events = 2, jumps = 2;
  static constexpr int user_values = 1;

  static constexpr const char* state_names[] = {"u1", "u2", "u3", "u4", "u5", "v1", "v2", "v3", "v4", "v5"};
  static constexpr const char* parameter_names[] = {"d", "f"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"stop", "maximum"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr const char* user_value_names[] = {"energy"};
  static constexpr double initial_parameters[] = {0.0, 0.0};
  static_assert(std::size(state_names) == dimension);

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T *u = x, *v = x + masses;
    for (int i = 0; i < masses; ++i) {
      f[i] = v[i];
      f[masses + i] = -spring(x, par, i);
      if (i + 1 < masses) f[masses + i] += spring(x, par, i + 1);
    }
    const T &tip = u[masses - 1], &tip_rate = v[masses - 1];
    f[dimension - 1] += par[1] * (1.0 - tip * tip) * tip_rate;
  }

  /// The force of the spring before mass i, and of the damper beside it.
  template <class T>
  static T spring(const T* x, const T* par, int i) {
    const T stretch = i > 0 ? T(x[i] - x[i - 1]) : x[0],
            rate = i > 0 ? T(x[masses + i] - x[masses + i - 1]) : x[masses];
    return stretch + par[0] * rate;
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return 1.0 - x[masses - 1];
    return x[dimension - 1];
  }

  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 1) g[dimension - 1] = -x[dimension - 1];
  }

  /// An orbit is cut at its impacts, and at maxima of the last mass before the stop.
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}}; }

  void user_value(const double* x, const double*, double* out) const {
    out[0] = 0.0;
    for (int i = 0; i < masses; ++i) {
      const double stretch = x[i] - (i > 0 ? x[i - 1] : 0.0), velocity = x[masses + i];
      out[0] += 0.5 * (velocity * velocity + stretch * stretch);
    }
  }
};

TCHAT_PROBLEM(BeamStop)

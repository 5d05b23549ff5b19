// The three-dimensional oscillator of problems/rand3d with forcing A cos(omega t), the dissertation's (5.76)-(5.78):
//
//     x1' = m x1 - x2 - x1 x3,   x2' = m x2 + x1 + A y2,   x3' = -x3 + x2^2 + x1^2 x3,   x1 >= mu,
//     x1' -> -r x1' at x1 = mu,
//
// made autonomous by y = (sin omega t, cos omega t), the attracting limit cycle of a planar oscillator. Attractors are
// seen on the section P, where x1 is at a minimum, and on P', where omega t is PAR(6).
#include <tchat/problem.hpp>

struct ForcedOscillator {
  static constexpr int dimension = 5, parameters = 6;
  static constexpr int fields = 1, events = 3, jumps = 4;

  static constexpr const char* state_names[] = {"x1", "x2", "x3", "y1", "y2"};
  static constexpr const char* parameter_names[] = {"mu", "A", "omega", "m", "r", "phase"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"wall", "minimum of x1", "phase"};
  static constexpr const char* jump_names[] = {"impact", "identity", "impact, cut at minima",
                                               "identity, cut at minima"};
  static constexpr double initial_parameters[] = {-0.4938, 1.25, 1.9, 0.28, 0.8, 3.0088915663};
  static constexpr double initial_state[] = {-0.3, 0.5, 0.2, 0.0, 1.0};

  static constexpr int user_values = 1;
  static constexpr const char* user_value_names[] = {"velocity"};

  /// x1'
  template <class T>
  static T velocity(const T* x, const T* par) {
    return (par[3] - x[2]) * x[0] - x[1];
  }

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T &A = par[1], &omega = par[2], &m = par[3];
    const T radius2 = x[3] * x[3] + x[4] * x[4];
    f[0] = velocity(x, par);
    f[1] = m * x[1] + x[0] + A * x[4];
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
    f[3] = x[3] + omega * x[4] - x[3] * radius2;
    f[4] = x[4] - omega * x[3] - x[4] * radius2;
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return x[0] - par[0];
    if (j == 2) return -velocity(x, par);
    return sin(par[5]) * x[4] - cos(par[5]) * x[3];  // sin(PAR(6) - omega t)
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < 5; ++i) g[i] = x[i];
    if (k == 1 || k == 3) g[1] = x[1] + (1.0 + par[4]) * velocity(x, par);
  }

  /// An orbit is cut at its impacts, or at the minima of x1 as long as it has none. Begun with jumps 3 and 4, which do
  /// what 1 and 2 do, it is cut at both: next to grazing impacts are too rare to tell how long a motion has been.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[2] >= 3) return {{1, 1, 3}, {1, 2, 4}};
    if (from[2] == 1) return {{1, 1, 1}};
    return {{1, 1, 1}, {1, 2, 2}};
  }

  /// x1' at the end of an orbit, before the impact, from the state after it; at the minimum of x1 it is zero.
  void user_value(const double* x, const double* par, double* out) const { out[0] = -velocity(x, par) / par[4]; }
};

TCHAT_PROBLEM(ForcedOscillator)

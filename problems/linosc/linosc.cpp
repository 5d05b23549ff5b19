// The periodically forced linear impact oscillator of the dissertation, equations (5.56)-(5.70):
//
//     q'' + 2 zeta q' + q = alpha cos(omega t),   q <= 1,   velocity -> -r velocity at q = 1.
//
// The forcing is made autonomous by y = (sin omega t, cos omega t), the attracting limit cycle of a planar oscillator.
#include <tchat/problem.hpp>

struct LinearOscillator {
  static constexpr int dimension = 4, parameters = 4;
  static constexpr int fields = 1, events = 3, jumps = 2;

  static constexpr const char* state_names[] = {"x1", "x2", "y1", "y2"};
  static constexpr const char* parameter_names[] = {"alpha", "omega", "zeta", "r"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"wall", "maximum of x1", "minimum of x1"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr double initial_parameters[] = {3.0, 2.0, 0.05, 0.8};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 1.0};  // at rest

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T &alpha = par[0], &omega = par[1], &zeta = par[2];
    const T radius2 = x[2] * x[2] + x[3] * x[3];
    f[0] = x[1];
    f[1] = alpha * x[3] - 2.0 * zeta * x[1] - x[0];
    f[2] = x[2] + omega * x[3] - x[2] * radius2;
    f[3] = x[3] - omega * x[2] - x[3] * radius2;
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return 1.0 - x[0];
    if (j == 2) return x[1];
    return -x[1];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < 4; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[3] * x[1];
  }

  /// For simulation: after everything comes the wall or, cutting an orbit that misses it, a maximum of x1.
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}}; }
};

TCHAT_PROBLEM(LinearOscillator)

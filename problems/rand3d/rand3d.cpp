// The three-dimensional oscillator of the dissertation, equations (5.73)-(5.75), between a wall and nothing:
//
//     x1' = m x1 - x2 - x1 x3,   x2' = m x2 + x1,   x3' = -x3 + x2^2 + x1^2 x3,   x1 >= mu,   x1' -> -r x1' at x1 = mu.
//
// The velocity x1' is no state: an impact changes x2 so that x1' = (m - x3) x1 - x2 becomes -r times what it was.
#include <tchat/problem.hpp>

struct ThreeDimensionalOscillator {
  static constexpr int dimension = 3, parameters = 3;
  static constexpr int fields = 1, events = 2, jumps = 2;

  static constexpr const char* state_names[] = {"x1", "x2", "x3"};
  static constexpr const char* parameter_names[] = {"mu", "m", "r"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"wall", "minimum of x1"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr double initial_parameters[] = {-0.9, 0.28, 0.8};
  static constexpr double initial_state[] = {-0.5, 0.3, 0.4};

  static constexpr int user_values = 1;
  static constexpr const char* user_value_names[] = {"velocity"};

  /// x1'
  template <class T>
  static T velocity(const T* x, const T* par) {
    return (par[1] - x[2]) * x[0] - x[1];
  }

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = velocity(x, par);
    f[1] = par[1] * x[1] + x[0];
    f[2] = -x[2] + x[1] * x[1] + x[0] * x[0] * x[2];
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return x[0] - par[0];
    return -velocity(x, par);
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < 3; ++i) g[i] = x[i];
    if (k == 1) g[1] = x[1] + (1.0 + par[2]) * velocity(x, par);
  }

  /// An orbit is cut at its impacts and at minima of x1 above the wall.
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}}; }

  /// x1' at the end of an orbit, before the impact, from the state after it; at the minimum of x1 it is zero.
  void user_value(const double* x, const double* par, double* out) const { out[0] = -velocity(x, par) / par[2]; }
};

TCHAT_PROBLEM(ThreeDimensionalOscillator)

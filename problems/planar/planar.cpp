// The planar oscillator of the dissertation, equations (3.1)-(3.2), between a wall and nothing:
//
//     x1' = x2,   x2' = -x1 - x2 (x1^2 - mu),   x1 <= d,   x2 -> -r x2 at x1 = d.
//
// Without the wall it is van der Pol's, with an attracting limit cycle for mu > 0.
#include <tchat/problem.hpp>

struct PlanarOscillator {
  static constexpr int dimension = 2, parameters = 3;
  static constexpr int fields = 1, events = 2, jumps = 2;

  static constexpr const char* state_names[] = {"x1", "x2"};
  static constexpr const char* parameter_names[] = {"mu", "d", "r"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"wall", "maximum of x1"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr double initial_parameters[] = {0.9, 2.008619860875, 0.8};
  static constexpr double initial_state[] = {1.0, 0.0};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -x[0] - x[1] * (x[0] * x[0] - par[0]);
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return par[1] - x[0];
    return x[1];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    g[0] = x[0];
    g[1] = k == 1 ? T(-par[2] * x[1]) : x[1];
  }

  /// An orbit is cut at its impacts and at maxima of x1 before the wall.
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}}; }
};

TCHAT_PROBLEM(PlanarOscillator)

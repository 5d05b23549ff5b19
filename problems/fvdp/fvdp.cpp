// The forced van der Pol oscillator of the dissertation, equations (3.15)-(3.17), beside a wall at x1 = mu:
//
//     x1' = x2,   x2' = -x1 - c x2 (x1^2 - 1) + A cos x3,   x3' = omega,   x1 <= mu,   x2 -> -r x2 at x1 = mu.
//
// x3 is the phase of the forcing, an angle between 0 and 2 pi: a revolution ends where it has reached 2 pi, and a jump
// takes 2 pi off. The two sections on which the dissertation shows attractors are event functions: P, where x1 is at a
// maximum, and P', where the phase is PAR(6).
#include <tchat/problem.hpp>

struct ForcedVanDerPol {
  static constexpr int dimension = 3, parameters = 6;
  static constexpr int fields = 1, events = 4, jumps = 3;

  static constexpr const char* state_names[] = {"x1", "x2", "x3"};
  static constexpr const char* parameter_names[] = {"mu", "c", "A", "omega", "r", "phase"};
  static constexpr const char* field_names[] = {"free flight"};
  static constexpr const char* event_names[] = {"wall", "maximum of x1", "phase", "revolution"};
  static constexpr const char* jump_names[] = {"impact", "identity", "less 2 pi"};
  static constexpr double initial_parameters[] = {2.5, 0.1, 0.75, 1.505, 0.8, 2.9236851};
  static constexpr double initial_state[] = {1.0, 0.0, 0.0};

  static constexpr double two_pi = 6.283185307179586;

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T &c = par[1], &A = par[2], &omega = par[3];
    f[0] = x[1];
    f[1] = -x[0] - c * x[1] * (x[0] * x[0] - 1.0) + A * cos(x[2]);
    f[2] = omega;
  }

  /// The sine of the phase that is left falls through zero at PAR(6) alone, whichever revolution x3 is in.
  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return par[0] - x[0];
    if (j == 2) return x[1];
    if (j == 3) return sin(par[5] - x[2]);
    return two_pi - x[2];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[4] * x[1];
    if (k == 3) g[2] = x[2] - two_pi;
  }

  /// An orbit is cut at its impacts, at maxima of x1 before the wall, and at the end of each revolution.
  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}, {1, 4, 3}}; }
};

TCHAT_PROBLEM(ForcedVanDerPol)

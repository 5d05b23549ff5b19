/// Two coupled pendula that rotate, driven by a constant torque I,
///
///     phi1'' + eps phi1' + sin phi1 = I + gamma (phi2 - phi1)    and the same with 1 and 2 exchanged;
///
/// both angles are set back by 2 pi where the first one has gone round.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Pendula {
  static constexpr int dimension = 4, parameters = 3, fields = 1, events = 1, jumps = 1;
  static constexpr double turn = 6.283185307179586;
  static constexpr const char* state_names[] = {"phi1", "phi2", "v1", "v2"};
  static constexpr const char* parameter_names[] = {"gamma", "eps", "I"};
  static constexpr double initial_parameters[] = {0.175, 0.1, 0.4};
  static constexpr double initial_state[] = {0.0, 0.0, 4.0, 4.0};

  template <class T>
  void field(int, const T* u, const T* par, T* f) const {
    using std::sin;
    f[0] = u[2];
    f[1] = u[3];
    f[2] = -par[1] * u[2] - sin(u[0]) + par[2] + par[0] * (u[1] - u[0]);
    f[3] = -par[1] * u[3] - sin(u[1]) + par[2] + par[0] * (u[0] - u[1]);
  }
  template <class T>
  T event(int, const T* u, const T*) const {
    return turn - u[0];
  }
  template <class T>
  void jump(int, const T* u, const T*, T* g) const {
    g[0] = u[0] - turn, g[1] = u[1] - turn;
    g[2] = u[2], g[3] = u[3];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}}; }
};

TCHAT_PROBLEM(Pendula)

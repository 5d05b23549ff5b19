// A pressure relief valve: a poppet on a spring above its seat, and the pressure of the reservoir that it relieves. G.
// Licsko, A. Champneys, C. Hos, Nonlinear analysis of a single stage pressure relief valve, IAENG Int. J. Appl. Math.
// 39 (2009) 286-299.
//
//     lift'' = -kappa lift' - (lift + delta) + pressure,    pressure' = beta (q - lift sqrt(pressure))
//
// Where the poppet hits its seat its velocity is reversed and r times as large. At low flow rates q it does so
// infinitely many times before it rests there, until the pressure has risen to delta.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Valve {
  static constexpr int dimension = 3, parameters = 5;
  static constexpr int fields = 2, events = 5, jumps = 4;

  static constexpr const char* state_names[] = {"lift", "speed", "pressure"};
  static constexpr const char* parameter_names[] = {"q", "r", "kappa", "beta", "delta"};
  static constexpr const char* field_names[] = {"open", "closed"};
  static constexpr const char* event_names[] = {"seat", "top", "opens", "margin", "time"};
  static constexpr const char* jump_names[] = {"impact", "identity", "settled", "opening"};
  static constexpr double initial_parameters[] = {0.1, 0.5, 1.25, 20.0, 10.0};
  static constexpr double initial_state[] = {0.0, 0.0, 10.0};

  static constexpr tchat::Chatter chatter{
      .field = 1, .event = 1, .impact = 1, .contact = 2, .release = 3, .limit = 3, .margin = 4, .leave = 4, .time = 5};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T &q = par[0], &kappa = par[2], &beta = par[3], &delta = par[4];
    f[0] = x[1];
    f[1] = x[2] - (x[0] + delta) - kappa * x[1];
    f[2] = beta * (q - x[0] * sqrt(x[2]));
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : x[1];  // the top is a section
  }
  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[1] * x[1];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}}; }
};

TCHAT_PROBLEM(Valve)

// A driven oscillator beside an elastic stop, a spring that holds on one side only:
//
//     q'' + 2 zeta q' + q + [q > gap] k (q - gap) = A cos(omega t)
//
// The force is continuous where the spring is touched, its derivative is not: two fields, and no jump of the state. The
// forcing is made autonomous by (sine, cosine)(omega t), the attracting circle of a planar oscillator.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct ElasticStop {
  static constexpr int dimension = 4, parameters = 5;
  static constexpr int fields = 2, events = 3, jumps = 1;

  static constexpr const char* state_names[] = {"q", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"A", "omega", "zeta", "k", "gap"};
  static constexpr const char* field_names[] = {"free", "in contact"};
  static constexpr const char* event_names[] = {"touch", "leave", "maximum of q"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {3.0, 2.5, 0.05, 4.0, 1.0};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 1.0};

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T &A = par[0], &omega = par[1], &zeta = par[2], &k = par[3], &gap = par[4];
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = A * x[3] - 2.0 * zeta * x[1] - x[0];
    if (i == 2) f[1] -= k * (x[0] - gap);
    f[2] = growth * x[2] + omega * x[3];
    f[3] = growth * x[3] - omega * x[2];
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return par[4] - x[0];
    if (j == 2) return x[0] - par[4];
    return x[1];
  }

  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }

  /// After the touch the spring holds until the mass leaves it. A free orbit that misses the stop is cut at its
  /// maximum.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[1] == 1) return {{2, 2, 1}};
    return {{1, 1, 1}, {1, 3, 1}};
  }
};

TCHAT_PROBLEM(ElasticStop)

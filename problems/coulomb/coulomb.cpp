// A mass on a spring and on a belt, with dry friction under a harmonic force, as a Filippov system on q' = V:
//
//     q'' + 2 zeta q' + q = A cos(omega t) - F sgn(q' - V)
//
// with V = zeta = 0 the oscillator of J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction,
// Trans. ASME 53 (1931) 107-115; with V > 0 that of S. W. Shaw, On the dynamic response of a system with dry friction,
// J. Sound and Vibration 108 (1986) 305-325, with equal static and sliding friction.
//
// State x = (q, v, s, c): (s, c) = (sin, cos)(omega t) as the attracting circle of a planar oscillator. Where the mass
// sticks to the belt it slides, in Filippov's sense, on v = V.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Coulomb {
  static constexpr int dimension = 4, parameters = 5;
  static constexpr int fields = 3, events = 5, jumps = 1;

  static constexpr const char* state_names[] = {"q", "v", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"A", "omega", "F", "V", "zeta"};
  static constexpr const char* field_names[] = {"slip forward", "slip backward", "stick"};
  static constexpr const char* event_names[] = {"v falls to V", "v rises to V", "slips backward", "slips forward",
                                                "phase"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {1.15, 0.7, 1.0, 0.0, 0.0};
  static constexpr double initial_state[] = {0.0, 0.5, 0.0, 1.0};

  static constexpr tchat::Sliding sliding{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3, .to_plus = 4};

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T &A = par[0], &omega = par[1], &F = par[2], &zeta = par[4];
    const T growth = 1.0 - x[2] * x[2] - x[3] * x[3];
    f[0] = x[1];
    f[1] = A * x[3] - 2.0 * zeta * x[1] - x[0] + (i == 1 ? -F : F);
    f[2] = growth * x[2] + omega * x[3];
    f[3] = growth * x[3] - omega * x[2];
  }
  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return x[1] - par[3];
    if (j == 2) return par[3] - x[1];
    return x[2];  // a section once in each period of the force
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double* par) const {
    const int next = tchat::next_field(*this, sliding, from, x, par);
    if (next == sliding.field) return {{3, 3, 1}, {3, 4, 1}};
    return {{next, next, 1}, {next, 5, 1}};  // event 1 ends field 1, event 2 field 2
  }
};

TCHAT_PROBLEM(Coulomb)

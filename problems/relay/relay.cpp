// A linear system of third order under relay feedback, as a Filippov system: x' = A x + B u, u = -sgn(x1), with
//
//         [ -(2 zeta omega + lambda)        1  0 ]        [ 1           ]
//     A = [ -(2 zeta omega lambda + omega^2) 0  1 ],  B = [ 2 sigma rho ],
//         [ -lambda omega^2                 0  0 ]        [ rho^2       ]
//
// of transfer function (s^2 + 2 sigma rho s + rho^2) / ((s^2 + 2 zeta omega s + omega^2)(s + lambda)): M. di Bernardo,
// K. H. Johansson and F. Vasca, Self-oscillations and sliding in relay feedback systems: symmetry and bifurcations,
// Int. J. Bifurcation and Chaos 11 (2001) 1121-1140.
//
// On x1 = 0 orbits slide while |x2| < 1. What is left there is x2' = x3 - 2 sigma rho x2, x3' = -rho^2 x2, the zeros of
// the transfer function: with sigma < 0 it leads away, and the system oscillates. It has the symmetry x -> -x.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Relay {
  static constexpr int dimension = 3, parameters = 5;
  static constexpr int fields = 3, events = 4, jumps = 1;

  static constexpr const char* state_names[] = {"x1", "x2", "x3"};
  static constexpr const char* parameter_names[] = {"zeta", "omega", "lambda", "sigma", "rho"};
  static constexpr const char* field_names[] = {"u = -1", "u = 1", "sliding"};
  static constexpr const char* event_names[] = {"x1 falls to 0", "x1 rises to 0", "x2 = -1", "x2 = 1"};
  static constexpr const char* jump_names[] = {"identity"};
  static constexpr double initial_parameters[] = {1.0, 1.0, 1.0, -1.0, 1.0};
  static constexpr double initial_state[] = {0.5, 0.5, 0.5};

  static constexpr tchat::Sliding sliding{.field = 3, .minus = 2, .plus = 1, .surface = 1, .to_minus = 3, .to_plus = 4};

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T &zeta = par[0], &omega = par[1], &lambda = par[2], &sigma = par[3], &rho = par[4];
    const double u = i == 1 ? -1.0 : 1.0;
    f[0] = -(2.0 * zeta * omega + lambda) * x[0] + x[1] + u;
    f[1] = -(2.0 * zeta * omega * lambda + omega * omega) * x[0] + x[2] + 2.0 * sigma * rho * u;
    f[2] = -lambda * omega * omega * x[0] + rho * rho * u;
  }
  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] : -x[0];
  }
  template <class T>
  void jump(int, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double* par) const {
    const int next = tchat::next_field(*this, sliding, from, x, par);
    if (next == sliding.field) return {{3, 3, 1}, {3, 4, 1}};
    return {{next, next, 1}};  // event 1 ends field 1, event 2 field 2
  }
};

TCHAT_PROBLEM(Relay)

/// Two masses between two walls, forced harmonically (sine, cosine as states):
///
///     m1 q1'' + c1 q1' + k1 q1 + c2 (q1' - q2') + k2 (q1 - q2) = a cos(omega t),   q1 <= g1, restitution r1
///     m2 q2'' + c2 (q2' - q1') + k2 (q2 - q1) = 0,                                 q2 >= -g2, restitution r2
///
/// The orbit with one impact at wall B has torus bifurcations.
#pragma once

#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct TwoWalls {
  static constexpr int dimension = 6, parameters = 6, fields = 1, events = 3, jumps = 3;
  static constexpr const char* state_names[] = {"q1", "v1", "q2", "v2", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"a", "omega", "g1", "g2", "r1", "r2"};
  static constexpr const char* event_names[] = {"wall A", "wall B", "phase pi"};
  static constexpr const char* jump_names[] = {"impact A", "impact B", "identity"};
  static constexpr double initial_parameters[] = {0.3, 1.5, 1.0, 1.0, 0.8, 0.7};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  static constexpr double m1 = 1.0, m2 = 0.5, c1 = 0.08, c2 = 0.05, k1 = 1.0, k2 = 0.7;

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T growth = 1.0 - x[4] * x[4] - x[5] * x[5];
    const T coupling = c2 * (x[1] - x[3]) + k2 * (x[0] - x[2]);
    f[0] = x[1];
    f[1] = (par[0] * x[5] - c1 * x[1] - k1 * x[0] - coupling) / m1;
    f[2] = x[3];
    f[3] = coupling / m2;
    f[4] = growth * x[4] + par[1] * x[5];
    f[5] = growth * x[5] - par[1] * x[4];
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return par[2] - x[0];
    if (j == 2) return x[2] + par[3];
    return x[4];
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 1) g[1] = -par[4] * x[1];
    if (k == 2) g[3] = -par[5] * x[3];
  }

  std::vector<std::array<int, 3>> successors(std::array<int, 3>) const { return {{1, 1, 1}, {1, 2, 2}, {1, 3, 3}}; }
};

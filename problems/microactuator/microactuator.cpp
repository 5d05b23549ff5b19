// The microactuator of the dissertation's section 2.2, for simulation: a mass m2 sprung inside a frame m1 on a
// horizontal floor, drawn to the frame's front by an electrostatic force Fe. Impacts of the mass on the frame's
// stoppers push the frame, which sticks to the floor by static friction and slips on it against dynamic friction.
//
//     F = Fe - c q' - k q,   Fe = V^2 sin^2(omega t) / (d - q)^2          force on the mass; the frame feels -F
//     stick:   u = 0,                            q'' = F / m2
//     slip+-:  p' = u,  u' = -F/m1 -+ mu_d N/m1,  q'' = (1/m1 + 1/m2) F +- mu_d N/m1       u > 0 or u < 0
//     impact:  q' -> -e q',  u -> u + (1 + e) m2/(m1 + m2) q'                  at q = delta or q = -delta
//
// State (p, u, q, q', y1, y2): position and velocity of the frame, displacement and velocity of the mass relative to
// it, and y = (sin, cos)(2 omega t) as the attracting circle of a planar oscillator (problems/mems is this system
// without p and with the parts that its orbits need). Nothing depends on p, so periodic motions step: p advances in
// each period.
//
// The ten index vectors J1..J10 of (2.41) are, in order, those of `stick`, `slip_plus` and `slip_minus` below.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct Microactuator {
  static constexpr int dimension = 6, parameters = 2;
  static constexpr int fields = 3, events = 6, jumps = 2;

  static constexpr const char* state_names[] = {"frame position", "frame velocity", "displacement",
                                                "velocity",       "sine",           "cosine"};
  static constexpr const char* parameter_names[] = {"V", "omega"};
  static constexpr const char* field_names[] = {"stick", "slip+", "slip-"};
  static constexpr const char* event_names[] = {"front", "back", "stick+", "stick-", "slip+", "slip-"};
  static constexpr const char* jump_names[] = {"impact", "identity"};
  static constexpr double initial_parameters[] = {0.79013593844, 0.8};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0};  // at rest

  static constexpr double m1 = 5.0, m2 = 1.0, k = 1.0, c = 0.04, d = 1.0, delta = 0.5, e = 0.8;
  static constexpr double dynamic_friction = 3.17844;  // mu_d N / m1
  static constexpr double static_friction = 23.544;    // mu_s N

  /// F, on the mass.
  template <class T>
  static T force(const T* x, const T* par) {
    const T gap = d - x[2];
    return 0.5 * (1.0 - x[5]) * par[0] * par[0] / (gap * gap) - c * x[3] - k * x[2];
  }

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T F = force(x, par);
    const double friction = i == 1 ? 0.0 : i == 2 ? dynamic_friction : -dynamic_friction;
    f[0] = i == 1 ? T(0.0) : x[1];
    f[1] = i == 1 ? T(0.0) : T(-F / m1 - friction);
    f[2] = x[3];
    f[3] = i == 1 ? T(F / m2) : T((1.0 / m1 + 1.0 / m2) * F + friction);
    const T radius2 = x[4] * x[4] + x[5] * x[5];
    f[4] = x[4] + 2.0 * par[1] * x[5] - x[4] * radius2;
    f[5] = x[5] - 2.0 * par[1] * x[4] - x[5] * radius2;
  }

  template <class T>
  T event(int j, const T* x, const T* par) const {
    if (j == 1) return delta - x[2];
    if (j == 2) return delta + x[2];
    if (j == 3) return static_friction + force(x, par);  // until the frame is pushed forward
    if (j == 4) return static_friction - force(x, par);  // until it is pushed back
    return j == 5 ? T(x[1]) : T(-x[1]);
  }

  template <class T>
  void jump(int k_jump, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k_jump == 2) return;
    g[1] = x[1] + (1.0 + e) * m2 / (m1 + m2) * x[3];
    g[3] = -e * x[3];
  }

  using IndexVectors = std::vector<std::array<int, 3>>;
  static IndexVectors stick() { return {{1, 1, 1}, {1, 2, 1}, {1, 3, 2}, {1, 4, 2}}; }
  static IndexVectors slip_plus() { return {{2, 1, 1}, {2, 2, 1}, {2, 5, 2}}; }
  static IndexVectors slip_minus() { return {{3, 1, 1}, {3, 2, 1}, {3, 6, 2}}; }

  /// The frame at rest: static friction holds it, or it is pushed forward or back.
  IndexVectors from_rest(const double* x, const double* par) const {
    if (event(3, x, par) <= 0.0) return slip_plus();
    if (event(4, x, par) <= 0.0) return slip_minus();
    return stick();
  }

  /// The index jump function, (2.42)-(2.46).
  IndexVectors successors(std::array<int, 3> from, const double* x, const double* par) const {
    if (from[1] == 3) return slip_plus();
    if (from[1] == 4) return slip_minus();
    if (from[1] == 5 || from[1] == 6) return from_rest(x, par);  // slip has ended: u = 0 but for rounding
    double g[dimension];  // after an impact; at the start of a simulation the state itself
    jump(from[2] == 1 ? 1 : 2, x, par, g);
    if (g[1] > 0.0) return slip_plus();
    if (g[1] < 0.0) return slip_minus();
    return from_rest(g, par);
  }
};

TCHAT_PROBLEM(Microactuator)

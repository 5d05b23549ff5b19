// The reduced MEMS impact oscillator of the dissertation's section 5.3.2 and Appendix C: a mass m2 sprung inside a
// frame m1 that sticks to the ground or slips on it, pulled by an electrostatic force F.
//
//     stick:  u' = 0,   q'' = F - c q' - k q
//     slip+:  u' = (k q + c q' - F - mu_d N) / m1,   q'' = (1 / m1 + 1 / m2) (F - c q' - k q) + mu_d N / m1
//     front:  q <= delta; at q = delta an impact turns q' into -e q', and u grows by (1 + e) m2 / (m1 + m2) q'
//     F = V^2 sin^2(omega t) / (d - q)^2 = V^2 (1 - cos 2 omega t) / 2 / (d - q)^2
//
// State x = (u, q, q', y1, y2): frame velocity, displacement and velocity of the mass relative to the frame, and
// y = (sin, cos)(2 omega t) as the attracting circle of a planar oscillator, so the forcing's period is pi / omega.
// The frame's own displacement, which nothing depends on, is left out.
//
// In stick u' = 0: with the identity jump nothing determines u, and an orbit that only sticks is a singular problem.
// The jump "stick" sets u = 0 and makes it regular.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct MemsOscillator {
  static constexpr int dimension = 5, parameters = 2;
  static constexpr int fields = 2, events = 3, jumps = 3;

  static constexpr const char* state_names[] = {"frame velocity", "displacement", "velocity", "sine", "cosine"};
  static constexpr const char* parameter_names[] = {"V", "omega"};
  static constexpr const char* field_names[] = {"stick", "slip+"};
  static constexpr const char* event_names[] = {"front", "end of slip", "maximum displacement"};
  static constexpr const char* jump_names[] = {"impact", "identity", "stick"};
  static constexpr double initial_parameters[] = {0.5641, 0.8};
  static constexpr double initial_state[] = {0.0, 0.0, 0.0, 0.0, 1.0};  // at rest

  static constexpr double m1 = 5.0, m2 = 1.0, k = 1.0, c = 0.04, d = 1.0, delta = 0.5, e = 0.8;
  static constexpr double friction = 3.17844;  // mu_d N / m1: the frame's deceleration in slip

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T &q = x[1], &v = x[2], &sine = x[3], &cosine = x[4];
    const T &voltage = par[0], &omega = par[1];
    const T gap = d - q;
    const T force = 0.5 * (1.0 - cosine) * voltage * voltage / (gap * gap) - c * v - k * q;  // on the mass
    f[0] = i == 1 ? T(0.0) : -force / m1 - friction;
    f[1] = v;
    f[2] = i == 1 ? force / m2 : (1.0 / m1 + 1.0 / m2) * force + friction;
    const T radius2 = sine * sine + cosine * cosine;
    f[3] = sine + 2.0 * omega * cosine - sine * radius2;
    f[4] = cosine - 2.0 * omega * sine - cosine * radius2;
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return delta - x[1];
    if (j == 2) return x[0];
    return x[2];
  }

  template <class T>
  void jump(int k_jump, const T* x, const T*, T* g) const {
    for (int i = 0; i < 5; ++i) g[i] = x[i];
    if (k_jump == 1) {
      g[0] = x[0] + (1.0 + e) * m2 / (m1 + m2) * x[2];
      g[2] = -e * x[2];
    }
    if (k_jump == 3) g[0] = 0.0;
  }

  // An impact sets the frame in motion; it slips until it rests, or until the next impact.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[2] == 1) return {{2, 1, 1}, {2, 2, 2}};
    return {{1, 1, 1}, {1, 3, 3}};
  }
};

TCHAT_PROBLEM(MemsOscillator)

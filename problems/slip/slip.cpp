// The spring-loaded inverted pendulum, a hopper and runner: a point mass (the hip) on a massless leg with a spring, and
// a hip spring that swings the leg in flight. Mass, gravity and rest length are 1. The model is that of
//
//     M. Raff, C. D. Remy, Continuation of periodic orbits in conservative hybrid dynamical systems and its application
//     to mechanical systems with impulsive dynamics, Nonlinear Dynamics (2025), with k = 40, w2 = 5;
//     M. Raff, N. Rosa, C. D. Remy, Connecting gaits in energetically conservative legged systems, IEEE RA-L (2022).
//
// The hip is at the height y and has the velocity (vx, vy); alpha is the angle of the leg, positive with the foot in
// front, and omega its rate. In flight the foot is at the height y - cos alpha. In stance it is fixed, the leg has the
// length l = y/cos alpha, and the force F along it acts on the hip:
//
//     flight    alpha' = omega, omega' = -w2 alpha;   y' = vy, vx' = 0, vy' = -1
//     stance    l alpha' = -(vx cos alpha + vy sin alpha),   l' = vy cos alpha - vx sin alpha,
//               y' = vy,  vx' = -F sin alpha,  vy' = F cos alpha - 1,   F = k (1 - l) - d l'
//     push      as stance, F + f: from the lowest point of the leg on
//
// Why the swing has no energy: a foot of mass mu on a hip spring of stiffness mu w2 has the energy mu (omega^2 + w2
// alpha^2)/2, which vanishes with mu at any w2. So do the torque of the hip spring in stance and the energy of the foot
// that is lost at landing. Hip and foot fall with the same acceleration, so gravity does not swing the leg. If d
// and f are 0, fields and jumps conserve
//
//     H = (vx^2 + vy^2)/2 + y + k/2 max(0, 1 - l)^2,   which is continuous where the leg has its rest length.
//
// Why there is no other neutral direction: the position of the foot is no state, only that of the hip relative to it.
// Flight conserves vx, H and omega^2 + w2 alpha^2, stance conserves H alone, so H is the only first integral. In stance
// four states determine alpha', and the fifth one satisfies omega' = alpha'' + alpha' - omega. Landing sets omega =
// alpha', and stance keeps that. In permanent stance a difference between them decays like exp(-t); with omega' =
// alpha'' it would be neutral, and the problem singular.
#include <array>
#include <cmath>
#include <tchat/problem.hpp>
#include <vector>

struct Slip {
  static constexpr int dimension = 5, parameters = 4;
  static constexpr int fields = 3, events = 3, jumps = 2;
  static constexpr int user_values = 1;

  static constexpr const char* state_names[] = {"alpha", "y", "vx", "vy", "omega"};
  static constexpr const char* parameter_names[] = {"k", "w2", "d", "f"};
  static constexpr const char* field_names[] = {"stance", "flight", "push"};
  static constexpr const char* event_names[] = {"lift-off", "touchdown", "shortest leg"};
  static constexpr const char* jump_names[] = {"identity", "landing"};
  static constexpr const char* user_value_names[] = {"energy"};
  static constexpr double initial_parameters[] = {40.0, 5.0, 0.0, 0.0};
  static constexpr double initial_state[] = {0.0, 1.1, 0.0, 0.0, 0.0};

  template <class T>
  void field(int i, const T* x, const T* par, T* f) const {
    const T &alpha = x[0], &y = x[1], &vx = x[2], &vy = x[3], &omega = x[4];
    f[1] = vy;
    if (i == 2) {
      f[0] = omega;
      f[2] = 0.0;
      f[3] = -1.0;
      f[4] = -par[1] * alpha;
      return;
    }
    const T s = sin(alpha), c = cos(alpha), length = y / c;
    const T turning = -(vx * c + vy * s) / length, lengthening = vy * c - vx * s;
    T force = par[0] * (1.0 - length) - par[2] * lengthening;
    if (i == 3) force += par[3];
    f[0] = turning;
    f[2] = -force * s;
    f[3] = force * c - 1.0;
    f[4] = (s - 2.0 * lengthening * turning) / length + turning - omega;
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    if (j == 1) return cos(x[0]) - x[1];
    if (j == 2) return x[1] - cos(x[0]);
    return x[2] * sin(x[0]) - x[3] * cos(x[0]);
  }

  /// At landing the foot stops, and the leg turns with the hip.
  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 2) g[4] = -(x[2] * cos(x[0]) + x[3] * sin(x[0]));
  }

  void user_value(const double* x, const double* par, double* out) const {
    const double shortening = std::fmax(0.0, 1.0 - x[1] / std::cos(x[0]));
    out[0] = 0.5 * (x[2] * x[2] + x[3] * x[3]) + x[1] + 0.5 * par[0] * shortening * shortening;
  }

  /// The leg pushes from where it is shortest to lift-off.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double*) const {
    const bool lifts_off = from[1] == 1, starts_above = from[0] == 0 && x[1] >= std::cos(x[0]);
    if (lifts_off || starts_above) return {{2, 2, 2}};
    if (from[1] == 3) return {{3, 1, 1}};
    return {{1, 3, 1}};
  }
};

TCHAT_PROBLEM(Slip)

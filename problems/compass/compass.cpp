// The compass gait: a biped of two stiff legs without knees, which walks down a slope without a motor.
// A. Goswami, B. Thuilot, B. Espiau, A study of the passive gait of a compass-like biped robot: symmetry and chaos,
// Int. J. Robotics Research 17 (1998) 1282-1301.
//
// Angles are measured from the vertical, counterclockwise. The stance leg turns about its foot, the swing leg about the
// hip. Each leg has a point mass m at the distance a from its foot and b from the hip, which has the mass mu m:
//
//     M(q) q'' + C(q, q') q' + G(q) + D q' = 0,   q = (swing, stance),   l = a + b,   beta = b / a,
//
// where D is a damper c in the hip. The walk is to the right, down the slope phi. When the swing foot meets the ground
// the legs change places; angular momentum is conserved about the new stance foot, and about the hip for the new swing
// leg. The foot is above the ground by l (cos(stance + phi) - cos(swing + phi)), a product of the functions of events 1
// and 2. Between their zeros in mid-stance the foot is below the ground, which the model ignores.
//
// Just before heel strike the stance leg may push off along itself, as in A. D. Kuo, Energetics of actively powered
// locomotion using the simplest walking model, J. Biomechanical Engineering 124 (2002) 113-120. Its impulse returns the
// share `push` of the energy that heel strike takes: with 1 a walk on level ground conserves energy.
#include <array>
#include <cmath>
#include <tchat/problem.hpp>
#include <vector>

struct CompassGait {
  static constexpr int dimension = 4, parameters = 5;
  static constexpr int fields = 1, events = 3, jumps = 2;
  static constexpr int user_values = 2;

  static constexpr const char* state_names[] = {"swing", "stance", "swing_rate", "stance_rate"};
  static constexpr const char* parameter_names[] = {"phi", "c", "mu", "beta", "push"};  // phi in degrees
  static constexpr const char* field_names[] = {"step"};
  static constexpr const char* event_names[] = {"strike", "pass", "clearance"};
  static constexpr const char* jump_names[] = {"heel strike", "identity"};
  static constexpr const char* user_value_names[] = {"step_length", "energy"};
  static constexpr double initial_parameters[] = {3.0, 0.0, 2.0, 1.0, 0.0};
  static constexpr double initial_state[] = {-0.33, 0.22, -0.38, -1.09};

  static constexpr double mass = 5.0, length = 1.0, gravity = 9.81, degree = 0.017453292519943295;

  template <class T>
  static T foot_to_mass(const T* par) {
    return length / (1.0 + par[3]);
  }

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T a = foot_to_mass(par), b = length - a, hip = par[2] * mass;
    const T difference = x[1] - x[0], coupling = mass * length * b * cos(difference);
    const T inertia = (hip + mass) * length * length + mass * a * a, own = mass * b * b;
    const T centrifugal = mass * length * b * sin(difference), damper = par[1] * (x[3] - x[2]);
    // own swing'' - coupling stance'' = on_swing,   inertia stance'' - coupling swing'' = on_stance
    const T on_swing = damper - centrifugal * x[3] * x[3] - mass * b * gravity * sin(x[0]);
    const T on_stance = centrifugal * x[2] * x[2] - damper + ((hip + mass) * length + mass * a) * gravity * sin(x[1]);
    const T determinant = own * inertia - coupling * coupling;
    f[0] = x[2];
    f[1] = x[3];
    f[2] = (inertia * on_swing + coupling * on_stance) / determinant;
    f[3] = (coupling * on_swing + own * on_stance) / determinant;
  }

  /// 1: both feet are on the ground, the swing foot in front where it falls. 2: the swing leg passes the stance leg.
  template <class T>
  T event(int j, const T* x, const T* par) const {
    const T slope = degree * par[0];
    if (j == 1) return x[0] + x[1] + 2.0 * slope;
    if (j == 2) return x[1] - x[0];
    return length * (cos(x[1] + slope) - cos(x[0] + slope));
  }

  template <class T>
  void jump(int k, const T* x, const T* par, T* g) const {
    for (int i = 0; i < dimension; ++i) g[i] = x[i];
    if (k == 2) return;
    const T a = foot_to_mass(par), b = length - a, hip = par[2] * mass, cosine = cos(x[0] - x[1]);
    // Before: about the new stance foot, and of the new swing leg about the hip.
    const T all = (hip * length * length + 2.0 * mass * a * length) * cosine * x[3] - mass * a * b * (x[2] + x[3]);
    const T leg = -mass * a * b * x[3];
    // After: p11 swing' + p12 stance' = all,   p21 swing' + p22 stance' = leg
    const T p11 = mass * b * (b - length * cosine), p21 = mass * b * b, p22 = -mass * b * length * cosine;
    const T p12 = mass * length * (length - b * cosine) + mass * a * a + hip * length * length;
    const T determinant = p11 * p22 - p12 * p21;
    g[0] = x[1];
    g[1] = x[0];
    g[2] = (p22 * all - p12 * leg) / determinant;
    g[3] = (p11 * leg - p21 * all) / determinant;
    // The impulse has this moment about the new stance foot, and none about the hip.
    const T moment = length * sin(x[1] - x[0]);
    const T turn[] = {g[0], g[1], p22 * moment / determinant, -p21 * moment / determinant};
    const T returned = par[4] * (energy_of(x, x, par) - energy_of(g, g, par));
    const T along = energy_of(g, turn, par), across = energy_of(turn, turn, par);
    const T root = sqrt(along * along + returned * across);
    const T impulse = returned / (along > 0.0 ? along + root : along - root);
    for (int i = 2; i < dimension; ++i) g[i] += impulse * turn[i];
  }

  /// Half of u' M w', of the rates of two motions at one position: the kinetic energy of one motion with itself.
  template <class T>
  static T energy_of(const T* u, const T* w, const T* par) {
    const T a = foot_to_mass(par), b = length - a;
    const T inertia = (par[2] * mass + mass) * length * length + mass * a * a, own = mass * b * b;
    const T coupling = mass * length * b * cos(u[1] - u[0]);
    return 0.5 * (own * u[2] * w[2] + inertia * u[3] * w[3] - coupling * (u[2] * w[3] + u[3] * w[2]));
  }

  /// Heel strike counts once the legs have passed each other.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from) const {
    if (from[1] == 2) return {{1, 1, 1}};
    return {{1, 2, 2}};
  }

  void user_value(const double* x, const double* par, double* out) const {
    const double a = foot_to_mass(par), b = length - a, all = (par[2] + 1.0) * length + a;
    out[0] = 2.0 * length * std::sin(0.5 * (x[1] - x[0]));
    out[1] = energy_of(x, x, par) + mass * gravity * (all * std::cos(x[1]) - b * std::cos(x[0]));
  }
};

TCHAT_PROBLEM(CompassGait)

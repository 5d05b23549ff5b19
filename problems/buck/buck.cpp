// The voltage-controlled buck converter of Fossas and Olivar (1996), in continuous conduction:
//
//     C v' = i - v / R,   L i' = -v (switch off),   L i' = Vin - v (switch on)
//
// The switch is on while the control voltage u = a (v - Vref) is below a ramp that begins anew at 3.8 V in each period
// of 400 us and ends at 8.2 V. Time is in periods of the ramp, and u, which moves as far as the ramp does, is the state
// instead of v: then every state and rate is of order 1.
#include <array>
#include <tchat/problem.hpp>
#include <vector>

struct BuckConverter {
  static constexpr int dimension = 3, parameters = 4;
  static constexpr int fields = 2, events = 3, jumps = 2;

  static constexpr const char* state_names[] = {"u", "i", "ramp"};
  static constexpr const char* parameter_names[] = {"Vin", "a", "R", "Vref"};
  static constexpr const char* field_names[] = {"off", "on"};
  static constexpr const char* event_names[] = {"u below the ramp", "u above the ramp", "end of the ramp"};
  static constexpr const char* jump_names[] = {"identity", "new ramp"};
  static constexpr double initial_parameters[] = {20.0, 8.4, 22.0, 11.3};
  static constexpr double initial_state[] = {5.0, 0.5, 3.8};

  static constexpr int user_values = 1;
  static constexpr const char* user_value_names[] = {"i0"};

  static constexpr double period = 400e-6, C = 47e-6, L = 20e-3, low = 3.8, high = 8.2;

  template <class T>
  void field(int k, const T* x, const T* par, T* f) const {
    const T &i = x[1], &Vin = par[0], &a = par[1], &R = par[2], &Vref = par[3];
    const T v = Vref + x[0] / a;
    f[0] = a * period / C * (i - v / R);
    f[1] = period / L * (k == 2 ? Vin - v : -v);
    f[2] = T(high - low);
  }

  template <class T>
  T event(int j, const T* x, const T*) const {
    return j == 1 ? x[0] - x[2] : j == 2 ? x[2] - x[0] : high - x[2];
  }

  template <class T>
  void jump(int k, const T* x, const T*, T* g) const {
    g[0] = x[0], g[1] = x[1], g[2] = k == 2 ? T(low) : x[2];
  }

  /// Off until u is below the ramp, on until it is above; a new ramp finds the switch in either place.
  std::vector<std::array<int, 3>> successors(std::array<int, 3> from, const double* x, const double*) const {
    const bool on = from[1] == 1 || (from[1] == 3 && x[0] < low) || (from[1] == 0 && x[0] < x[2]);
    if (on) return {{2, 2, 1}, {2, 3, 2}};
    return {{1, 1, 1}, {1, 3, 2}};
  }

  /// The current where the last ramp ends.
  void user_value(const double* x, const double*, double* out) const { out[0] = x[1]; }
};

TCHAT_PROBLEM(BuckConverter)

/// Predators y and prey x of the capacity K, with a harvest that begins when there are P predators.
///
///     x' = x (1 - x / K) - x y / (1 + x)
///     y' = y (x / (1 + x) - d)
///     the harvest begins where P - y falls to zero
///
/// The model of Rosenzweig and MacArthur without harvest: smooth, with one event function to watch.
#include <tchat/problem.hpp>

struct Predator {
  static constexpr int dimension = 2, parameters = 3, fields = 1, events = 1;
  static constexpr const char* state_names[] = {"prey", "predators"};
  static constexpr const char* parameter_names[] = {"K", "d", "P"};
  static constexpr const char* event_names[] = {"harvest"};
  static constexpr double initial_parameters[] = {0.5, 0.5, 1.6};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    const T eaten = x[0] / (T(1.0) + x[0]);
    f[0] = x[0] * (T(1.0) - x[0] / par[0]) - eaten * x[1];
    f[1] = x[1] * (eaten - par[1]);
  }

  template <class T>
  T event(int, const T* x, const T* par) const {
    return par[2] - x[1];
  }
};
TCHAT_PROBLEM(Predator)

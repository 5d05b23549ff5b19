/// Euler's elastica: a thin rod of length 1 and stiffness 1 between hinges, under an axial load.
///
///     angle'' = -load sin(angle),   angle'(0) = angle'(1) = 0,   integral of 1 - shortening - cos(angle) = 0
///
/// The last condition is that the hinges have come nearer by the shortening. Time is the arclength along the rod.
#include <tchat/problem.hpp>

struct Elastica {
  static constexpr int dimension = 2, parameters = 2, fields = 1;
  static constexpr const char* state_names[] = {"angle", "curvature"};
  static constexpr const char* parameter_names[] = {"load", "shortening"};
  static constexpr double initial_parameters[] = {5.0, 0.0};

  template <class T>
  void field(int, const T* x, const T* par, T* f) const {
    f[0] = x[1];
    f[1] = -par[0] * sin(x[0]);
  }

  static constexpr int boundary_conditions = 2;
  template <class T>
  void boundary(const tchat::Ends<T>& rod, const T*, T* b) const {
    b[0] = rod.start(1)[1];
    b[1] = rod.end(1)[1];
  }

  static constexpr int integral_conditions = 1;
  template <class T>
  void integrand(int, const T* x, const T* par, T* q) const {
    q[0] = T(1.0) - par[1] - cos(x[0]);
  }
};
TCHAT_PROBLEM(Elastica)

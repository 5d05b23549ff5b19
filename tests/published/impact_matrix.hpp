/// Multipliers of an orbit of the linear impact oscillator with m impacts from its impact states alone, in closed form.
///
/// Over a flight of duration T deviations (dq, dq') go with E(T), the flow of q'' + 2 zeta q' + q = 0; over an impact
/// of velocity v, accelerations a- before and a+ after it,
///
///     dq -> -r dq,   dq' -> -r dq' + (a+ + r a-) dq / v.
///
/// Nothing here asks for v > 0: it holds for the inadmissible solutions too. Multiplied by the v's, det(M - Id) and
/// det(M + Id) are smooth through v = 0; their zeros are the folds or branch points and the period doublings.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "published/chain.hpp"

namespace test_support {

inline Eigen::Matrix2d free_flow(double time) {
  const double frequency = std::sqrt(1.0 - zeta * zeta);
  const double c = std::cos(frequency * time);
  const double s = std::sin(frequency * time) / frequency;
  Eigen::Matrix2d flow;
  flow << c + zeta * s, s, -s, c - zeta * s;
  return std::exp(-zeta * time) * flow;
}

/// v times the impact's matrix; forcing = alpha cos(omega t) at the impact.
inline Eigen::Matrix2d scaled_impact(double v, double forcing) {
  const double before = forcing - 2.0 * zeta * v - 1.0;
  const double after = forcing + 2.0 * zeta * restitution * v - 1.0;
  Eigen::Matrix2d impact;
  impact << -restitution * v, 0.0, after + restitution * before, -restitution * v;
  return impact;
}

struct ScaledMonodromy {
  double velocities = 1.0;                               ///< product of the v's
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Identity();  ///< that product times M

  explicit ScaledMonodromy(const SolutionEntry& solution) {
    const auto& end = solution.states.back();
    for (std::size_t s = 0; s < end.size() / 4; ++s) {
      const double v = end[4 * s + 1];
      velocities *= v;
      matrix = scaled_impact(v, solution.parameter(1) * end[4 * s + 3]) *
               free_flow(solution.parameter(61 + static_cast<int>(s))) * matrix;
    }
  }
  double determinant() const { return matrix.determinant() / velocities; }  // of M, times the v's
  double at_plus_one() const { return velocities - matrix.trace() + determinant(); }
  double at_minus_one() const { return velocities + matrix.trace() + determinant(); }
};

}  // namespace test_support

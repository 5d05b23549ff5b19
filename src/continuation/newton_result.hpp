/// How Newton's method has fared at a point of a branch.
#pragma once

#include <algorithm>
#include <string>

namespace tchat {

enum class NewtonStatus { converged, too_many_iterations, diverging, not_finite, singular, condition_lost };

/// One line of the Newton history.
struct NewtonIteration {
  int number = 0;
  double parameter = 0.0;         ///< the first free problem parameter after the correction
  double parameter_change = 0.0;  ///< largest |dp| / (1 + |p|)
  double state_change = 0.0;      ///< max |du| / (1 + max |u|)
  double residual = 0.0;          ///< largest residual before the correction
  double larger() const { return std::max(parameter_change, state_change); }
};

struct NewtonResult {
  NewtonStatus status = NewtonStatus::too_many_iterations;
  int iterations = 0;
  double residual = 0.0;  ///< largest, at the last evaluation
  /// How far x has moved, in the measures of the convergence test, since the factors were computed.
  double change_since_factorization = 0.0;
  bool from_tangent = false;  ///< it began on the tangent of the last point
  bool converged() const { return status == NewtonStatus::converged; }
};

std::string describe(NewtonStatus status);

}  // namespace tchat

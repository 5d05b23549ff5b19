/// The smooth periodic orbit through a grazing point, and its return map from x* to x* on P (2.5.2), by forward
/// integration.
///
/// Unknowns x* (n), the duration T of the last segment and one parameter p; equations
///
///     x* returns to x* (n),   h_D(x*, p) = 0,   h_P(x*, p) = 0,
///
/// n + 2 each: the orbit of a label is moved to the contact itself, and to the accuracy of the integrator.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "maps/grazing_point.hpp"
#include "model/index_vector.hpp"

namespace tchat {

/// An orbit cut at its contact: where the search begins.
struct ContactTurn {
  IndexVector contact;       ///< (f, h_D, g_D)
  Signature aftermath = {};  ///< see GrazingPoint
  Eigen::VectorXd x;         ///< near x*, n
  ParameterVector par;
  /// Of the section that the contact lies on, which does not move x*: it belongs to the smooth orbit.
  int section_jump = no_function;
  /// From x* to x*, contact and aftermath left out. The last segment ends at x*: (f, h_D, no_function).
  Signature segments;
  std::vector<double> durations;  ///< of each
  int parameter = 1;              ///< PAR index that moves the orbit to the contact
};

struct GrazingOrbit {
  GrazingPoint point;
  Signature segments;             ///< as in ContactTurn
  std::vector<double> durations;  ///< of each
  int parameter = 1;
  Eigen::MatrixXd A;              ///< derivative of the smooth return map on P, n x n; A f = 0 and h_{P,x} A = 0
  Eigen::MatrixXd by_parameters;  ///< of its value by PAR(1), PAR(2), ..., the problem's parameters: n x parameters
  Eigen::VectorXcd multipliers;   ///< eigenvalues of A, largest modulus first; one is zero
  double moved = 0.0;             ///< of PAR(parameter), from the turn's value

  double period() const;
};

/// Throws UserError, beginning with `source`, where grazing_point() does, and ComputationError when the turn cannot be
/// integrated or Newton's method does not converge near it.
GrazingOrbit find_grazing_orbit(const HybridSystem& system, const ContactTurn& turn, const std::string& source);

}  // namespace tchat

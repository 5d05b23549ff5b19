/// Where a torus of the smooth flow touches an event surface: the least h_D over all its trajectories.
///
/// Unknowns phi, sigma and one parameter p; equations
///
///     h_P(X_0) = 0,  X_0 = Phi(u(phi), sigma),      h_{D,x}(X_0) Phi_x u'(phi) = 0,      h_D(X_0, p) = 0
///
/// X_0 is where the trajectory through u(phi) meets P (2.73); on P itself sigma = 0. What the parameter does to the
/// torus is not accounted for: nothing where only h_D depends on it.
#pragma once

#include <Eigen/Core>
#include <string>

#include "maps/torus_return.hpp"
#include "model/hybrid_system.hpp"
#include "model/parameter_vector.hpp"

namespace tchat {

struct TorusGrazing {
  double phase = 0.0;   ///< phi*
  double time = 0.0;    ///< sigma, from the section to P
  Eigen::VectorXd x;    ///< x*, on P
  ParameterVector par;  ///< with the value at which it touches
};

/// Field `field`, event function `wall`, PAR(`parameter`) moves. Throws UserError, beginning with `source`, when the
/// section does not pass through a point of least h_D, and when h_D does not depend on the parameter.
TorusGrazing torus_grazing(const HybridSystem& system, const TorusReturn& torus, int field, int wall, int parameter,
                           const std::string& source);

}  // namespace tchat

/// A grazing point (2.57-2.60): a state x* at which a trajectory touches an event surface D from h_D > 0.
///
/// With h_P = h_{D,x} f, x* lies on h_D = h_P = 0, and a* = h_{P,x} f > 0 there: h_D has a simple minimum along the
/// trajectory, and P (h_P = 0) is a section that all trajectories nearby cross, whether they touch D or not. The jump
/// g_D of the contact leaves states with h_D = h_P = 0 as they are.
///
///     beta = (Id - f h_{P,x} / a*) G f,      B = -sqrt(2/a*) beta        (2.112, 4.18, corrected)
///
/// G = g_{D,x}; where short segments in other fields follow the impact (a slip, before the mass sticks again), each of
/// them multiplies it by g_x (Id - f h_x / (h_x f)) from the left.
#pragma once

#include <Eigen/Core>
#include <string>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "stability/grazing_response.hpp"

namespace tchat {

struct GrazingPoint {
  int field = 1;             ///< f, before the contact and after it
  int event = 1;             ///< h_D
  int jump = 1;              ///< g_D
  Signature aftermath = {};  ///< segments in other fields after the impact, of no duration at x*; mostly none
  Eigen::VectorXd x;         ///< x*, n
  ParameterVector par;       ///< of the problem's layout

  double a = 0.0;                    ///< a* = h_{P,x} f
  Eigen::VectorXd f;                 ///< n
  Eigen::VectorXd event_gradient;    ///< h_{D,x}, n
  Eigen::VectorXd section_gradient;  ///< h_{P,x}, n
  Eigen::MatrixXd jump_derivative;   ///< G, n x n
  ImpactDirection impact;            ///< beta and its uncertainty
  Eigen::VectorXd B;                 ///< n; the coefficient of sqrt(-h_D) in the discontinuity map on P

  /// False in a plane, and wherever contact has no effect of first order: beta is zero within its uncertainty.
  bool has_square_root() const;
};

/// Of a state that lies on h_D = h_P = 0 but for rounding (`corrected_contact` sees to that). `par` has
/// PAR of the problem's layout. Throws UserError, beginning with `source`, when a* is not positive, when x* is not on
/// both surfaces, when the jump is the identity, when it moves states in grazing contact, or when a segment of the
/// aftermath does not begin on the surface on which it ends.
GrazingPoint grazing_point(const HybridSystem& system, int field, int event, int jump, const Eigen::VectorXd& x,
                           const ParameterVector& par, const std::string& source, const Signature& aftermath = {});

/// The state with h_D = h_P = 0 at these parameters that is nearest to x, by Newton's method. Throws UserError,
/// beginning with `source`, when there is none near.
Eigen::VectorXd corrected_contact(const HybridSystem& system, int field, int event, const Eigen::VectorXd& x,
                                  const ParameterVector& par, const std::string& source);

}  // namespace tchat

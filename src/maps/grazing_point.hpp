/// Grazing points, sections through them, and short flows near them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "model/parameter_vector.hpp"
#include "orbit/ring_system.hpp"
#include "stability/grazing_tests.hpp"

namespace tchat {

// P' (2.71-2.79): a section through a grazing point that is not P.

/// The level of an event function, or of one state, through x*. It is crossed by the flow, in either direction.
struct CrossSection {
  int event = 0;  ///< from 1; 0: the hyperplane of a constant state
  int state = 0;  ///< from 1, where event = 0
};

// A grazing point (2.57-2.60): a state x* at which a trajectory touches an event surface D from h_D > 0.
//
// With h_P = h_{D,x} f, x* lies on h_D = h_P = 0, and a* = h_{P,x} f > 0 there: h_D has a simple minimum along the
// trajectory, and P (h_P = 0) is a section that all trajectories nearby cross, whether they touch D or not. The jump
// g_D of the contact leaves states with h_D = h_P = 0 as they are.
//
//     beta = (Id - f h_{P,x} / a*) G f,      B = -sqrt(2/a*) beta        (2.112, 4.18, corrected)
//
// G = g_{D,x}; where short segments in other fields follow the impact (a slip, before the mass sticks again), each of
// them multiplies it by g_x (Id - f h_x / (h_x f)) from the left.

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

// Short flows near a grazing point, in deviations d = x - x*.
//
// With deviations all that is small keeps its digits: the field's rounding is relative to the length of the flow, and
// h_D, h_P and what a jump changes come from integrals of their gradients between x* and x* + d instead of differences
// of values. Along the flow h_D' = h_P and h_P' = a(x) = h_{P,x} f are integrated with it.
//
// x* is taken to lie on h_D = h_P = 0 and to be left as it is by the jump, exactly, at the parameters `base`.
// Explicit Runge-Kutta steps of order 8 with errors at rounding level. Flows that cannot be followed (a function
// without a value, a zero that is not there) return false.

class LocalFlow {
 public:
  /// Views of all four, which outlive this object. `contact`: (f, h_D, g_D). Deviations are from x*, at parameters
  /// `par`.
  LocalFlow(const HybridSystem& system, const IndexVector& contact, const Eigen::VectorXd& x_star,
            const ParameterVector& base, const ParameterVector& par);

  const ParameterVector& parameters() const { return par_; }

  double height(const Eigen::VectorXd& d);                    ///< h_D(x* + d)
  Eigen::VectorXd height_gradient(const Eigen::VectorXd& d);  ///< h_{D,x} there
  double rate(const Eigen::VectorXd& d);                      ///< h_P(x* + d)
  double acceleration(const Eigen::VectorXd& d);              ///< h_{P,x} f there
  /// Of P' (or its level through x*): its function and gradient at x* + d.
  double section(const CrossSection& section, const Eigen::VectorXd& d);
  Eigen::VectorXd section_gradient(const CrossSection& section, const Eigen::VectorXd& d);
  Eigen::VectorXd field(const Eigen::VectorXd& d);
  /// g_D(x* + d) - x*; `derivative`, where given, is multiplied by g_{D,x} from the left.
  Eigen::VectorXd jumped(const Eigen::VectorXd& d, Eigen::MatrixXd* derivative = nullptr);

  /// d flows to where h_D has risen by y^2 from its least value: backward for y > 0, forward for y < 0 (2.63, 2.66).
  /// `derivative` (n columns of changes of d) becomes that of the flow to the surface h_D = 0 itself.
  bool to_height(Eigen::VectorXd& d, double y, Eigen::MatrixXd* derivative = nullptr);
  /// d flows to h_P = 0 (2.65, 2.67).
  bool to_least_height(Eigen::VectorXd& d, Eigen::MatrixXd* derivative = nullptr);
  /// d flows to P' (2.74, 2.76).
  bool to_section(Eigen::VectorXd& d, const CrossSection& section, Eigen::MatrixXd* derivative = nullptr);

 private:
  struct Motion;
  Motion motion(const Eigen::VectorXd& d, const CrossSection* section, bool variational) const;
  void slopes(const Motion& motion, const std::vector<double>& z, std::vector<double>& out);
  bool follow(Motion& motion, double time);
  bool to_zero(Motion& motion);
  Eigen::VectorXd state(const Eigen::VectorXd& d) const { return x_star_ + d; }
  void change(const Motion& motion, const Eigen::VectorXd& gradient, Eigen::MatrixXd& derivative);

  const HybridSystem& system_;
  IndexVector contact_;
  const Eigen::VectorXd& x_star_;
  const ParameterVector& base_;
  const ParameterVector& par_;
  bool is_at_base_;
  SurfaceRate surface_;
  Eigen::VectorXd x_, f_, g_;
  Eigen::MatrixXd fx_;
  double height_offset_ = 0.0, rate_offset_ = 0.0;  // of x* at `par`
  Eigen::VectorXd jump_offset_;
};

}  // namespace tchat

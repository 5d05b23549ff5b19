/// What contact of low velocity does to first order, and how it comes back (2.111-2.112, 4.22, corrected).
///
/// With x* a grazing point of event surface D, h_P = h_{D,x} f, a* = h_{P,x} f > 0 and A the derivative of the return
/// map from x* to x* on h_P = 0 that ignores the contact:
///
///     beta = (Id - f h_{P,x} / a*) g_{D,x} f,     xi_n = -h_{D,x} A^n beta.
///
/// xi_n > 0: no new impact n returns after one of low velocity.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace tchat {

/// beta and how well it is known. It is a difference: where contact has no effect of first order, as in a plane or
/// where an impact only stops the approach, rounding is all that is left of its two terms.
struct ImpactDirection {
  Eigen::VectorXd beta;      ///< n
  double uncertainty = 0.0;  ///< of |beta|: orbit_accuracy |g_{D,x}| |f| (1 + |f| |h_{P,x}| / a*)

  bool is_zero() const { return !(beta.norm() > uncertainty); }
  /// beta and, in n more columns, what may be added to it: n x (1 + n).
  Eigen::MatrixXd with_errors() const;
};

/// Of f, h_{P,x} and g_{D,x} at x*.
ImpactDirection impact_direction(const Eigen::VectorXd& f, const Eigen::VectorXd& section_gradient,
                                 const Eigen::MatrixXd& jump_derivative);

struct ImpactReturn {
  double xi = 0.0;
  /// |h_x| times the larger of |A^n beta| and |A^(n-1) beta| times orbit_accuracy, and |h_x| times what the
  /// uncertainty of beta adds to A^n beta. The powers decay where A contracts, and xi_n with them: that is no zero.
  double uncertainty = 0.0;

  bool is_zero() const { return !(std::abs(xi) > uncertainty); }
};

/// xi_n of A^(n-1) and A^n times `with_errors()`.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& before,
                           const Eigen::MatrixXd& last);
/// xi_n, n >= 1. Beyond 2^-900 and 2^900 xi_n and its uncertainty stop at that size and keep their sign.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                           const ImpactDirection& direction, int n);
/// xi_1 ... xi_count likewise.
std::vector<ImpactReturn> impact_returns(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                                         const ImpactDirection& direction, int count);

}  // namespace tchat

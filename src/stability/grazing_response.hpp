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
#include <vector>

namespace tchat {

/// beta, n entries, of f, h_{P,x} and g_{D,x} at x*.
Eigen::VectorXd impact_direction(const Eigen::VectorXd& f, const Eigen::VectorXd& section_gradient,
                                 const Eigen::MatrixXd& jump_derivative);

struct ImpactReturn {
  double xi = 0.0;
  /// What xi_n is small or large against: |h_x| times the larger of |A^n beta| and |A^(n-1) beta|. The powers decay
  /// where A contracts, and xi_n with them: that is no zero.
  double scale = 0.0;
};

/// xi_n of A^(n-1) beta and A^n beta.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::VectorXd& before,
                           const Eigen::VectorXd& last);
/// xi_n, n >= 1. Beyond 2^-900 and 2^900 xi_n and its scale stop at that size and keep their sign.
ImpactReturn impact_return(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                           const Eigen::VectorXd& beta, int n);
/// xi_1 ... xi_count likewise.
std::vector<ImpactReturn> impact_returns(const Eigen::VectorXd& event_gradient, const Eigen::MatrixXd& return_map,
                                         const Eigen::VectorXd& beta, int count);

}  // namespace tchat

/// Floquet multipliers of a return map from the flow Jacobians of its segments, (2.26):
///
///     P_s = (Id - f h_x / (h_x f)) Phi_s,   M = g_{m,x} P_m ... g_{1,x} P_1.
///
/// Where a segment ends (nearly) in contact, h_x f = 0 to a thousandth of |h_x| |f|, nothing is divided: the change
/// sigma of its duration stays an unknown, with the equation h_x (Phi_s v + sigma f) = 0. With all such sigma the
/// multipliers are those of the pencil
///
///     [R Q; C D] (v; sigma) = mu [Id 0; 0 0] (v; sigma),
///
/// infinite ones among them. Computed by plain products and dense eigenvalues, independent of collocation and of the
/// periodic QZ iteration: small multipliers beside large ones are accurate to rounding in the large ones only.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace tchat {

/// One segment: all at its end x_s(1), n x n, n, row of n, n x n.
struct SegmentLink {
  Eigen::MatrixXd flow;  ///< Phi_s
  Eigen::VectorXd f;
  Eigen::RowVectorXd hx;
  Eigen::MatrixXd gx;
};

class ReturnPencil {
 public:
  /// `links` of one period, in order; at least one.
  explicit ReturnPencil(const std::vector<SegmentLink>& links);

  /// n multipliers, largest modulus first; infinite ones are 1e99. Empty when an entry of the links is not finite.
  std::vector<std::complex<double>> multipliers() const;

  /// False where any number would do: at the end of a curve of folds or period doublings on the grazing curve, to
  /// `tolerance`.
  bool determines_multipliers(double tolerance) const;

  /// The relative size of the least change of the pencil that makes mu a multiplier (0: it is one).
  double backward_error(std::complex<double> mu) const;

 private:
  Eigen::Index dimension_;
  Eigen::MatrixXd a_;  // [R Q; C D]
};

/// Largest difference of two sets of multipliers, each of one matched with one of the other: |a - b| / max(1, |a|), of
/// those beyond 1e6 their reciprocals'. The pair of smallest modulus is left out: the structural zero, which tchat's
/// files give as its size in the discretisation.
double largest_difference(std::vector<std::complex<double>> stored, std::vector<std::complex<double>> computed);

}  // namespace tchat

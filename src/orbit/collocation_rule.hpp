/// Orthogonal collocation on one mesh interval (5.26-5.29), scaled to sigma in [0, 1]: Lagrange polynomials of degree c
/// on c + 1 equally spaced nodes, collocated at the c Gauss points. These are in the order in which elimination of the
/// interior nodes finds its pivots in a short interval, so that rows are seldom exchanged.
#pragma once

#include <Eigen/Core>

namespace tchat {

class CollocationRule {
 public:
  static constexpr int most_points = 7;

  /// c = number of collocation points, 2..most_points.
  explicit CollocationRule(int points);

  int points() const { return points_; }

  Eigen::VectorXd gauss;      ///< c: Gauss points
  Eigen::VectorXd weights;    ///< c: Gauss weights of the interval, of unit sum
  Eigen::MatrixXd value;      ///< c x (c+1): value(j, i) = l_i(gauss_j)
  Eigen::MatrixXd slope;      ///< c x (c+1): slope(j, i) = l_i'(gauss_j)
  Eigen::MatrixXd mass;       ///< (c+1) x (c+1): integral of l_i l_k over the interval, exact
  Eigen::VectorXd integral;   ///< c+1: integral of l_i
  Eigen::VectorXd highest;    ///< c+1: the c-th derivative of sum u_i l_i is sum highest_i u_i
  double interpolation;       ///< largest |prod (sigma - node_i)| / (c+1)!: of the error between mesh points
  Eigen::MatrixXd end_slope;  ///< 2 x (c+1): l_i'(0), l_i'(1)
  double residual_integral;   ///< max |integral of Pi from 0 to sigma| / |Pi(0)|, Pi = prod (sigma - gauss_j)

  /// l_i(sigma) and l_i'(sigma) for i = 0..c; either may be null.
  void basis(double sigma, double* values, double* slopes) const;

 private:
  void basis_values(double sigma, double* values) const;

  int points_;
  Eigen::VectorXd nodes_;
  Eigen::VectorXd barycentric_;  // weights 1 / prod_k (node_i - node_k)
};

}  // namespace tchat

/// Closed curves by their values at N = 2 Q + 1 equal phases, and the trigonometric polynomial through them.
///
///     u(phi) = sum_l K(phi - l / N) u_l,     K(t) = (1 + 2 sum_{k=1..Q} cos 2 pi k t) / N
///
/// K and its derivatives are all there is: shifted by rho the curve has the values sum_l K(rho + (i - l) / N) u_l, a
/// circulant matrix; its derivative by phi likewise with K'.
#pragma once

#include <Eigen/Core>

namespace tchat {

/// Weights of u_0 .. u_{N-1} in u(phi), or in its derivative of an order from 0 by phi; N odd.
Eigen::RowVectorXd interpolation_weights(int count, double phi, int derivative = 0);

/// The same into a vector of N entries: allocates nothing.
void set_interpolation_weights(double phi, int derivative, Eigen::RowVectorXd& weights);

/// The curve whose values are the columns of `values`, by `count` values (odd): harmonics that are new are zero, those
/// that are too many are left out.
Eigen::MatrixXd resampled_curve(const Eigen::MatrixXd& values, int count);

/// Sizes of the harmonics k = 0..Q, the largest over the rows: |a_k - i b_k| of a_k cos 2 pi k phi + b_k sin 2 pi k
/// phi, each row divided by its entry of `scale`.
Eigen::VectorXd harmonic_sizes(const Eigen::MatrixXd& values, const Eigen::VectorXd& scale);

}  // namespace tchat

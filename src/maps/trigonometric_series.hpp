/// A vector function of period 1 as a trigonometric polynomial:
///
///     F(phi) = a_0 + sum_l a_l cos 2 pi l phi + b_l sin 2 pi l phi,   l = 1..Q
#pragma once

#include <Eigen/Core>

namespace tchat {

class TrigonometricSeries {
 public:
  TrigonometricSeries() = default;
  /// rows x (2 Q + 1), the columns a_0, a_1, b_1, a_2, b_2, ...
  explicit TrigonometricSeries(Eigen::MatrixXd coefficients) : coefficients_(std::move(coefficients)) {}
  /// Least squares at phases anywhere, rows x K values.
  static TrigonometricSeries fitted(const Eigen::MatrixXd& values, const Eigen::VectorXd& phases, int harmonics);
  /// Through values at phi = 0, 1/N, 2/N, ...; N odd, Q = (N - 1) / 2.
  static TrigonometricSeries through(const Eigen::MatrixXd& values);

  Eigen::Index rows() const { return coefficients_.rows(); }
  int harmonics() const { return static_cast<int>(coefficients_.cols() / 2); }
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

  Eigen::VectorXd operator()(double phi) const { return derivative(phi, 0); }
  /// Derivative of an order from 0.
  Eigen::VectorXd derivative(double phi, int order) const;

 private:
  Eigen::MatrixXd coefficients_;
};

}  // namespace tchat

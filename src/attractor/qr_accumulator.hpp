/// Lyapunov exponents of a sequence of matrices, by Householder QR: an orthonormal frame Q is multiplied by each matrix
/// and made orthonormal again, A Q = Q' R; the exponents are the means of ln |R_jj|.
#pragma once

#include <Eigen/Core>

#include "attractor/growth_series.hpp"

namespace tchat {

/// n x K, orthonormal columns, carried along. Growth that is not told yet is kept in `logarithms`.
class OrthonormalFrame {
 public:
  /// 1 <= columns <= n. The first frame is a fixed one in general position.
  OrthonormalFrame(Eigen::Index n, Eigen::Index columns);

  Eigen::Index columns() const { return v_.cols(); }
  /// The frame times what has been multiplied to it since orthonormalise().
  const Eigen::MatrixXd& vectors() const { return v_; }
  /// v <- matrix v; without making it orthonormal.
  void multiply(const Eigen::MatrixXd& matrix);
  /// V = Q R; V <- Q, and ln |R_jj| is added to the growth. A direction that vanishes, |R_jj| <= 1e-13 |V|, has lost
  /// all: minus infinity.
  void orthonormalise();
  /// Growth since the last call.
  Eigen::VectorXd take_growth();
  /// Is every entry finite?
  bool is_finite() const { return v_.allFinite(); }
  void restore(const Eigen::MatrixXd& vectors) { v_ = vectors; }

 private:
  Eigen::MatrixXd v_, moved_;
  Eigen::VectorXd growth_;
};

/// For maps: one matrix after the other, each one piece of the motion.
class QrAccumulator {
 public:
  /// 1 <= columns <= n: how many exponents.
  QrAccumulator(Eigen::Index n, Eigen::Index columns) : frame_(n, columns), series_(columns) {}

  /// n x n, and how long it took (1 for exponents per iterate). A matrix that is not finite is left out and counted.
  void pass(const Eigen::MatrixXd& matrix, double duration = 1.0);
  /// Events: matrices passed.
  LyapunovSpectrum spectrum() const;

 private:
  OrthonormalFrame frame_;
  GrowthSeries series_;
  long left_out_ = 0;
};

}  // namespace tchat

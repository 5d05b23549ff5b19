/// Lyapunov exponents of a sequence of matrices, by Householder QR: an orthonormal frame Q is multiplied by each matrix
/// and made orthonormal again, A Q = Q' R; the exponents are the means of ln |R_jj|.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

#include "motion/growth_series.hpp"

namespace tchat {

/// n x K, carried along; orthonormal after each orthonormalise(). Allocates nothing after construction.
class OrthonormalFrame {
 public:
  /// 1 <= columns <= n. The first frame is a fixed one in general position.
  OrthonormalFrame(Eigen::Index n, Eigen::Index columns);

  /// Columns to be multiplied by what transports them.
  Eigen::MatrixXd& vectors() { return v_; }
  const Eigen::MatrixXd& vectors() const { return v_; }
  /// V = Q R; V <- Q, and ln |R_jj| is added to the growth. A direction that vanishes to rounding against the others
  /// has lost all: minus infinity; unless `may_vanish` is false, where that is rounding of large numbers.
  void orthonormalise(bool may_vanish = true);
  /// ln |R_jj| added since the last call.
  const Eigen::VectorXd& take_growth();

 private:
  Eigen::MatrixXd v_;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::VectorXd growth_, taken_, workspace_;
};

/// For maps: one matrix after the other, each one piece of the motion.
class QrAccumulator {
 public:
  /// 1 <= columns <= n: how many exponents.
  QrAccumulator(Eigen::Index n, Eigen::Index columns) : frame_(n, columns), series_(columns) {}

  /// n x n, and how long it took (1 for exponents per iterate). A matrix that is not finite is left out, and
  /// counted in `tangential`.
  void pass(const Eigen::MatrixXd& matrix, double duration = 1.0);
  /// `events` are matrices.
  LyapunovSpectrum spectrum() const;
  /// The direction that has grown fastest, behind the last matrix: n, of unit length.
  Eigen::VectorXd growing_direction() const { return frame_.vectors().col(0); }

 private:
  OrthonormalFrame frame_;
  GrowthSeries series_;
  long left_out_ = 0;
};

}  // namespace tchat

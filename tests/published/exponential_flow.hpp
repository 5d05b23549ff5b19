/// Orbits of affine systems by matrix exponentials: x' = A x + b as (x, 1)' = [A b; 0 0] (x, 1).
#pragma once

#include <Eigen/Dense>

#include "support/random_matrices.hpp"

namespace test_support {

class AffineFlow {
 public:
  template <class Matrix, class Offset>
  AffineFlow(const Eigen::MatrixBase<Matrix>& A, const Eigen::MatrixBase<Offset>& b)
      : generator_(Eigen::MatrixXd::Zero(A.rows() + 1, A.rows() + 1)) {
    generator_.topLeftCorner(A.rows(), A.cols()) = A;
    generator_.topRightCorner(A.rows(), 1) = b;
  }

  Eigen::VectorXd after(double time, const Eigen::VectorXd& x) const {
    const Eigen::Index n = x.size();
    Eigen::VectorXd extended(n + 1);
    extended << x, 1.0;
    const Eigen::MatrixXd flow = tchat::test::exponential(generator_ * time);
    return (flow * extended).head(n);
  }

 private:
  Eigen::MatrixXd generator_;
};

}  // namespace test_support

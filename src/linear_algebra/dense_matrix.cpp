#include "linear_algebra/dense_matrix.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace tchat {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) { return matrix.eigenvalues(); }

Eigen::MatrixXd solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.partialPivLu().solve(right);
}

Eigen::MatrixXd solve_with_complete_pivoting(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.fullPivLu().solve(right);
}

double distance_to_null_space(const Eigen::MatrixXd& rows, const Eigen::VectorXd& x) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows.transpose());
  const Eigen::VectorXd turned = qr.householderQ().adjoint() * x;
  return turned.head(rows.rows()).norm();
}

double least_singular_value(const Eigen::MatrixXcd& matrix) {
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXcd>(matrix).singularValues();
  return singular(singular.size() - 1);
}

}  // namespace tchat

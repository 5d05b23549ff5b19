/// What is asked of small dense matrices outside the Newton loop, by LAPACK: Eigen's decompositions take half a minute
/// to compile.
#pragma once

#include <Eigen/Core>
#include <complex>

namespace tchat {

/// Of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// The eigenvector of unit length that belongs to (about) this eigenvalue, by inverse iteration.
Eigen::VectorXcd eigenvector(const Eigen::MatrixXd& matrix, std::complex<double> eigenvalue);

/// x of (matrix - shift Id) x = right.
Eigen::VectorXcd solve_shifted(const Eigen::MatrixXd& matrix, std::complex<double> shift,
                               const Eigen::VectorXcd& right);

/// Gaussian elimination of a square matrix with row pivoting.
class PivotedLu {
 public:
  explicit PivotedLu(const Eigen::MatrixXd& matrix);

  /// x of matrix x = right, columns of `right` side by side; not finite where the matrix is singular.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// The determinant is the product of these and of the sign of the row exchanges.
  Eigen::VectorXd pivots() const { return factors_.diagonal(); }
  int parity() const;

 private:
  Eigen::MatrixXd factors_;
  Eigen::VectorXi pivots_;  // row that row k was exchanged with, from 1
};

/// PivotedLu(matrix).solve(right).
Eigen::MatrixXd solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// The same with complete pivoting: finite, where the matrix is singular too. Unknowns of pivots that are rounding are
/// 0.
Eigen::MatrixXd solve_with_complete_pivoting(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// The shortest x that makes |matrix x - right| least, columns of `right` side by side; directions in which the matrix
/// is singular to rounding are left out. Finite, where the matrix is singular too.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// matrix = Q [R; 0] with orthogonal Q; at least as many rows as columns.
class HouseholderQr {
 public:
  explicit HouseholderQr(const Eigen::MatrixXd& matrix);

  Eigen::VectorXd diagonal() const { return factors_.diagonal(); }  ///< of R
  int parity() const;                                               ///< determinant of Q
  Eigen::MatrixXd turned(const Eigen::MatrixXd& right) const;       ///< Q^T right

 private:
  Eigen::MatrixXd factors_;
  Eigen::VectorXd scalars_;  // of the reflections
};

/// Length of the shortest d with rows (x + d) = 0: of the part of x in the space of the rows, which are independent and
/// fewer than the columns. It does not depend on how large each row is.
double distance_to_null_space(const Eigen::MatrixXd& rows, const Eigen::VectorXd& x);

double least_singular_value(const Eigen::MatrixXcd& matrix);

}  // namespace tchat

/// What is asked of small dense matrices outside the Newton loop, mostly by LAPACK: Eigen's decompositions take half a
/// minute to compile.
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

/// Takes the first columns, not more than there are rows, to an upper triangle by reflections from the left, in place;
/// the other columns are reflected too. Returns the determinant of the reflections, 1 or -1.
int triangularise(Eigen::MatrixXd& matrix, Eigen::Index columns);

/// Length of the shortest d with rows (x + d) = 0: of the part of x in the space of the rows, which are independent and
/// fewer than the columns. It does not depend on how large each row is. `columns` holds the rows as columns and x
/// behind them, and is overwritten.
double distance_to_null_space(Eigen::MatrixXd& columns);

double least_singular_value(const Eigen::MatrixXcd& matrix);

}  // namespace tchat

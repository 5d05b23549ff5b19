/// Small dense matrices, mostly by LAPACK, and Householder's reflections.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <optional>

namespace tchat {

// Householder's reflections 1 - w w^T, |w|^2 = 2, applied in place. For matrices of a few rows, where LAPACK's
// workspaces and blocks of columns take longer than the arithmetic.

namespace detail {

/// make_reflection() of a vector of this norm, neither zero nor too large or small to be squared.
template <class Vector>
double make_reflection_of_norm(Vector& x, double norm) {
  const double image = std::copysign(norm, -x(0));
  x(0) -= image;
  x *= 1.0 / std::sqrt(norm * std::abs(x(0)));
  return image;
}

}  // namespace detail

/// x becomes w of the reflection that takes x to a multiple of the first unit vector. Returns the multiple: |x|, with
/// the sign that x(0) has not. x = 0 stays what it is: no reflection.
template <class Vector>
double make_reflection(Vector&& x) {
  constexpr double largest = 1e200;
  const double square = x.squaredNorm();
  if (square < largest && square * largest > 1.0) return detail::make_reflection_of_norm(x, std::sqrt(square));
  const double size = x.cwiseAbs().maxCoeff();
  if (size == 0.0) return 0.0;
  x /= size;
  return size * detail::make_reflection_of_norm(x, x.norm());
}

/// (1 - w w^T) matrix. The transposed matrix is reflected from the right.
template <class Vector, class Matrix>
void reflect(const Vector& w, Matrix&& matrix) {
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    auto column = matrix.col(j);
    column -= w.dot(column) * w;
  }
}

// What is asked of small dense matrices, mostly by LAPACK: Eigen's decompositions take half a minute to compile. These
// allocate, unless they say that they do not: not for what is done at each step of Newton's method in large numbers.

/// Of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// The same of a symmetric matrix, whose lower triangle is read, in ascending order.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// The eigenvectors of a square matrix as columns: matrix right = right diag(values), left^T matrix = diag(values)
/// left^T.
struct Eigenvectors {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd right, left;
};
/// None where the matrix is not finite or the iteration fails.
std::optional<Eigenvectors> eigenvectors(const Eigen::MatrixXd& matrix);

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
  double determinant() const { return parity() * pivots().prod(); }
  /// Whether no pivot is rounding against the largest.
  bool is_regular() const;

 private:
  Eigen::MatrixXd factors_;
  Eigen::VectorXi pivots_;  // row that row k was exchanged with, from 1
};

/// The rows in which it finds its pivots. Those of symmetric rows are equal up to rounding, so that no library decides
/// which rounds in its own way on each processor.
Eigen::VectorXi elimination_order(Eigen::MatrixXd matrix);

/// PivotedLu(matrix).solve(right).
Eigen::MatrixXd solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// The same of complex numbers, for one right-hand side after the other. Allocates nothing after construction.
class ComplexLu {
 public:
  explicit ComplexLu(Eigen::Index n) : factors_(n, n), pivots_(n) {}
  explicit ComplexLu(const Eigen::MatrixXcd& matrix) : ComplexLu(matrix.rows()) { factorize(matrix); }

  void factorize(const Eigen::MatrixXcd& matrix);
  /// x, the right-hand side, becomes the solution; not finite where the matrix is singular.
  void solve_in_place(Eigen::VectorXcd& x) const;

 private:
  Eigen::MatrixXcd factors_;
  Eigen::VectorXi pivots_;
};

/// ComplexLu(matrix), of one right-hand side.
Eigen::VectorXcd solve_complex(const Eigen::MatrixXcd& matrix, const Eigen::VectorXcd& right);

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

/// A square matrix as left diag(sizes) right^T, with descending sizes; all NaN if the matrix is not finite.
struct SingularVectors {
  Eigen::VectorXd sizes;
  Eigen::MatrixXd left, right;
};
SingularVectors singular_vectors(const Eigen::MatrixXd& matrix);

/// Makes the columns of n x K matrices, K <= n, orthonormal, V = Q R. Allocates nothing after construction.
class Orthonormalisation {
 public:
  Orthonormalisation(Eigen::Index rows, Eigen::Index columns);

  /// V becomes Q.
  void apply(Eigen::MatrixXd& v);
  /// |R_jj| of the last matrix.
  const Eigen::VectorXd& lengths() const { return lengths_; }

 private:
  Eigen::VectorXd lengths_, factors_, work_;
};

}  // namespace tchat

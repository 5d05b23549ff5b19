#include "linear/dense_matrix.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/levels.hpp"
#include "linear/lapack.hpp"

namespace tchat {

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

int size_of(Eigen::Index k) { return static_cast<int>(k); }

/// More than any of the routines here needs for matrices of so many rows and columns together.
std::vector<double> workspace(Eigen::Index rows_and_columns) {
  constexpr Eigen::Index blocks = 64;
  return std::vector<double>(static_cast<std::size_t>(blocks * (rows_and_columns + 1)));
}

}  // namespace

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  const int n = size_of(matrix.rows());
  if (n == 0) return {};
  if (!matrix.allFinite()) return Eigen::VectorXcd::Constant(n, not_a_number);
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXd real(n);
  Eigen::VectorXd imag(n);
  std::vector<double> work = workspace(n);
  const int work_size = static_cast<int>(work.size());
  const int one = 1;
  int info = 0;
  dgeev_("N", "N", &n, a.data(), &n, real.data(), imag.data(), nullptr, &one, nullptr, &one, work.data(), &work_size,
         &info, 1, 1);
  if (info != 0) return Eigen::VectorXcd::Constant(n, not_a_number);
  Eigen::VectorXcd result(n);
  result.real() = real;
  result.imag() = imag;
  return result;
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  const int n = size_of(matrix.rows());
  if (n == 0) return {};
  if (!matrix.allFinite()) return Eigen::VectorXd::Constant(n, not_a_number);
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXd values(n);
  std::vector<double> work = workspace(n);
  const int work_size = static_cast<int>(work.size());
  int info = 0;
  dsyev_("N", "L", &n, a.data(), &n, values.data(), work.data(), &work_size, &info, 1, 1);
  return info == 0 ? values : Eigen::VectorXd::Constant(n, not_a_number);
}

namespace {

/// Vectors as LAPACK packs them: those of a pair are real and imaginary part of the first one in two columns.
Eigen::MatrixXcd unpacked(const Eigen::MatrixXd& packed, const Eigen::VectorXd& imag) {
  Eigen::MatrixXcd vectors(packed.rows(), packed.cols());
  for (Eigen::Index j = 0; j < packed.cols(); ++j) {
    if (imag(j) == 0.0 || j + 1 == packed.cols()) {
      vectors.col(j) = packed.col(j);
      continue;
    }
    vectors.col(j).real() = packed.col(j);
    vectors.col(j).imag() = packed.col(j + 1);
    vectors.col(j + 1) = vectors.col(j).conjugate();
    ++j;
  }
  return vectors;
}

}  // namespace

std::optional<Eigenvectors> eigenvectors(const Eigen::MatrixXd& matrix) {
  const int n = size_of(matrix.rows());
  if (n == 0 || !matrix.allFinite()) return std::nullopt;
  Eigen::MatrixXd a = matrix, left(n, n), right(n, n);
  Eigen::VectorXd real(n), imag(n);
  std::vector<double> work = workspace(n);
  const int work_size = static_cast<int>(work.size());
  int info = 0;
  dgeev_("V", "V", &n, a.data(), &n, real.data(), imag.data(), left.data(), &n, right.data(), &n, work.data(),
         &work_size, &info, 1, 1);
  if (info != 0) return std::nullopt;
  Eigenvectors found{Eigen::VectorXcd(n), unpacked(right, imag), unpacked(left, imag).conjugate()};
  found.values.real() = real;
  found.values.imag() = imag;
  return found;
}

Eigen::VectorXcd solve_shifted(const Eigen::MatrixXd& matrix, std::complex<double> shift,
                               const Eigen::VectorXcd& right) {
  const Eigen::Index n = matrix.rows();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd parts(2 * n, 2 * n);
  parts << matrix - shift.real() * identity, shift.imag() * identity, -shift.imag() * identity,
      matrix - shift.real() * identity;
  Eigen::VectorXd both(2 * n);
  both << right.real(), right.imag();
  const Eigen::VectorXd solution = solve(parts, both);
  Eigen::VectorXcd result(n);
  result.real() = solution.head(n);
  result.imag() = solution.tail(n);
  return result;
}

Eigen::VectorXcd eigenvector(const Eigen::MatrixXd& matrix, std::complex<double> eigenvalue) {
  constexpr double beside = level::rounding_of_sums;  // the matrix is to be nearly singular, not singular
  const std::complex<double> shift = eigenvalue + beside * (std::abs(eigenvalue) + matrix.norm());
  Eigen::VectorXcd v(matrix.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = {std::cos(1.0 + 0.7 * static_cast<double>(i)), 0.3};
  for (int round = 0; round < 3; ++round) v = solve_shifted(matrix, shift, v.normalized().eval());
  return v.normalized();
}

PivotedLu::PivotedLu(const Eigen::MatrixXd& matrix) : factors_(matrix), pivots_(factors_.rows()) {
  const int n = size_of(factors_.rows());
  int info = 0;
  if (n > 0) dgetrf_(&n, &n, factors_.data(), &n, pivots_.data(), &info);
}

int PivotedLu::parity() const {
  int sign = 1;
  for (Eigen::Index k = 0; k < pivots_.size(); ++k) sign = pivots_(k) == k + 1 ? sign : -sign;
  return sign;
}

bool PivotedLu::is_regular() const {
  const Eigen::VectorXd sizes = pivots().cwiseAbs();
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(sizes.size());
  return sizes.size() == 0 || sizes.minCoeff() > rounding * sizes.maxCoeff();
}

Eigen::VectorXi elimination_order(Eigen::MatrixXd a) {
  const int n = size_of(a.rows());
  Eigen::VectorXi rows = Eigen::VectorXi::LinSpaced(n, 0, n - 1);
  for (int k = 0; k < n; ++k) {
    Eigen::Index below = 0;
    a.col(k).tail(n - k).cwiseAbs().maxCoeff(&below);
    a.row(k).swap(a.row(k + below));
    std::swap(rows(k), rows(k + below));
    for (int i = k + 1; i < n; ++i) a.row(i) -= a(i, k) / a(k, k) * a.row(k);
  }
  return rows;
}

Eigen::MatrixXd PivotedLu::solve(const Eigen::MatrixXd& right) const {
  const int n = size_of(factors_.rows());
  const int right_sides = size_of(right.cols());
  Eigen::MatrixXd x = right;
  int info = 0;
  if (x.size() > 0) dgetrs_("N", &n, &right_sides, factors_.data(), &n, pivots_.data(), x.data(), &n, &info, 1);
  return x;
}

Eigen::MatrixXd solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return PivotedLu(matrix).solve(right);
}

void ComplexLu::factorize(const Eigen::MatrixXcd& matrix) {
  const int n = size_of(matrix.rows());
  factors_ = matrix;
  int info = 0;
  if (n > 0) zgetrf_(&n, &n, factors_.data(), &n, pivots_.data(), &info);
}

void ComplexLu::solve_in_place(Eigen::VectorXcd& x) const {
  const int n = size_of(x.size());
  const int one = 1;
  int info = 0;
  if (n > 0) zgetrs_("N", &n, &one, factors_.data(), &n, pivots_.data(), x.data(), &n, &info, 1);
}

Eigen::VectorXcd solve_complex(const Eigen::MatrixXcd& matrix, const Eigen::VectorXcd& right) {
  Eigen::VectorXcd x = right;
  ComplexLu(matrix).solve_in_place(x);
  return x;
}

Eigen::MatrixXd solve_with_complete_pivoting(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  const int n = size_of(matrix.rows());
  Eigen::MatrixXd x = right;
  if (n == 0) return x;
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXi rows(n);
  Eigen::VectorXi columns(n);
  int info = 0;
  dgetc2_(&n, a.data(), &n, rows.data(), columns.data(), &info);
  for (int k = 0; k < n; ++k) x.row(k).swap(x.row(rows(k) - 1));
  for (int k = 0; k < n; ++k)
    for (int i = k + 1; i < n; ++i) x.row(i) -= a(i, k) * x.row(k);
  // A pivot that vanishes is made a small number by the routine.
  using Limits = std::numeric_limits<double>;
  const double least =
      std::max(Limits::epsilon() * n * matrix.cwiseAbs().maxCoeff(), Limits::min() / Limits::epsilon());
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) x.row(k) -= a(k, j) * x.row(j);
    if (std::abs(a(k, k)) > least)
      x.row(k) /= a(k, k);
    else
      x.row(k).setZero();
  }
  for (int k = n - 1; k >= 0; --k) x.row(k).swap(x.row(columns(k) - 1));
  return x;
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  const int rows = size_of(matrix.rows());
  const int columns = size_of(matrix.cols());
  const int right_sides = size_of(right.cols());
  const int longer = std::max(rows, columns);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(longer, right_sides);
  x.topRows(rows) = right;
  if (!matrix.allFinite() || !right.allFinite()) return Eigen::MatrixXd::Constant(columns, right_sides, not_a_number);
  Eigen::MatrixXd a = matrix;
  Eigen::VectorXi order = Eigen::VectorXi::Zero(columns);
  std::vector<double> work = workspace(rows + columns + right_sides);
  const int work_size = static_cast<int>(work.size());
  const double least_condition = std::numeric_limits<double>::epsilon() * longer;
  int rank = 0;
  int info = 0;
  if (a.size() > 0)
    dgelsy_(&rows, &columns, &right_sides, a.data(), &rows, x.data(), &longer, order.data(), &least_condition, &rank,
            work.data(), &work_size, &info);
  return x.topRows(columns);
}

int triangularise(Eigen::MatrixXd& matrix, Eigen::Index columns) {
  int determinant = 1;
  for (Eigen::Index k = 0; k < columns; ++k) {
    const Eigen::Index rows = matrix.rows() - k;
    auto column = matrix.col(k).tail(rows);
    const double diagonal = make_reflection(column);
    if (diagonal == 0.0) continue;
    reflect(column, matrix.bottomRightCorner(rows, matrix.cols() - k - 1));
    column.setZero();
    column(0) = diagonal;
    determinant = -determinant;
  }
  return determinant;
}

double distance_to_null_space(Eigen::MatrixXd& columns) {
  const Eigen::Index rows = columns.cols() - 1;
  triangularise(columns, rows);
  return columns.col(rows).head(rows).norm();
}

double least_singular_value(const Eigen::MatrixXcd& matrix) {
  const int rows = size_of(matrix.rows());
  const int columns = size_of(matrix.cols());
  const int shorter = std::min(rows, columns);
  if (!matrix.allFinite()) return not_a_number;
  Eigen::MatrixXcd a = matrix;
  Eigen::VectorXd singular(shorter);
  Eigen::VectorXcd work(64 * (rows + columns));
  Eigen::VectorXd real_work(5 * shorter);
  const int work_size = size_of(work.size());
  const int one = 1;
  int info = 0;
  zgesvd_("N", "N", &rows, &columns, a.data(), &rows, singular.data(), nullptr, &one, nullptr, &one, work.data(),
          &work_size, real_work.data(), &info, 1, 1);
  return info == 0 ? singular(shorter - 1) : not_a_number;
}

SingularVectors singular_vectors(const Eigen::MatrixXd& matrix) {
  const int n = size_of(matrix.rows());
  const Eigen::MatrixXd none = Eigen::MatrixXd::Constant(n, n, not_a_number);
  SingularVectors found{Eigen::VectorXd::Constant(n, not_a_number), none, none};
  if (n == 0 || !matrix.allFinite()) return found;
  Eigen::MatrixXd a = matrix, transposed(n, n);
  std::vector<double> work = workspace(n);
  const int work_size = static_cast<int>(work.size());
  int info = 0;
  dgesvd_("A", "A", &n, &n, a.data(), &n, found.sizes.data(), found.left.data(), &n, transposed.data(), &n, work.data(),
          &work_size, &info, 1, 1);
  if (info != 0) return {none.diagonal(), none, none};
  found.right = transposed.transpose();
  return found;
}

Orthonormalisation::Orthonormalisation(Eigen::Index rows, Eigen::Index columns)
    : lengths_(columns), factors_(columns), work_(64 * (rows + columns)) {}

void Orthonormalisation::apply(Eigen::MatrixXd& v) {
  const int rows = size_of(v.rows());
  const int columns = size_of(v.cols());
  const int work_size = size_of(work_.size());
  int info = 0;
  dgeqrf_(&rows, &columns, v.data(), &rows, factors_.data(), work_.data(), &work_size, &info);
  lengths_ = v.diagonal().cwiseAbs();
  dorgqr_(&rows, &columns, &columns, v.data(), &rows, factors_.data(), work_.data(), &work_size, &info);
}

}  // namespace tchat

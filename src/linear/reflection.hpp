/// Householder's reflections 1 - w w^T, |w|^2 = 2, applied in place. For matrices of a few rows, where LAPACK's
/// workspaces and blocks of columns take longer than the arithmetic.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace tchat {

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

}  // namespace tchat

#include "stability/cyclic_determinant.hpp"

#include <algorithm>
#include <cmath>

#include "linear_algebra/dense_matrix.hpp"

namespace tchat {

ScaledReal& ScaledReal::operator*=(double factor) {
  int shift = 0;
  mantissa_ = std::frexp(mantissa_ * factor, &shift);
  exponent_ += shift;
  return *this;
}

ScaledReal& ScaledReal::operator*=(const ScaledReal& other) {
  exponent_ += other.exponent_;
  return *this *= other.mantissa_;
}

ScaledReal& ScaledReal::operator/=(const ScaledReal& other) {
  exponent_ -= other.exponent_;
  return *this *= 1.0 / other.mantissa_;
}

double ScaledReal::value(double cap) const {
  constexpr long beyond = 4000;  // of any double
  const double size = std::ldexp(std::abs(mantissa_), static_cast<int>(std::clamp(exponent_, -beyond, beyond)));
  return std::copysign(std::min(size, cap), mantissa_);
}

ScaledReal determinant(const Eigen::MatrixXd& matrix) {
  ScaledReal result;
  if (matrix.size() == 0) return result;
  const PivotedLu lu(matrix);
  result *= static_cast<double>(lu.parity());
  for (const double pivot : lu.pivots()) result *= pivot;
  return result;
}

/// With W^T [e; -A_s] = [R; 0], W orthogonal, the lower rows of W^T are free of c_{s-1}: what is left of e c_{s-1} =
/// a c_0 and E_s c_s = A_s c_{s-1} there is a relation of c_s and c_0 like the first one.
CyclicDeterminant::CyclicDeterminant(const std::vector<Eigen::MatrixXd>& e, const std::vector<Eigen::MatrixXd>& a)
    : e_(e.front()), a_(a.front()) {
  const Eigen::Index n = e_.rows();
  if (n == 0) return;
  for (std::size_t s = 1; s < e.size(); ++s) {
    Eigen::MatrixXd column(2 * n, n);
    column << e_, -a[s];
    const HouseholderQr qr(column);
    for (const double entry : qr.diagonal()) eliminated_ *= entry;
    eliminated_ *= static_cast<double>(qr.parity());
    Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    rest.topLeftCorner(n, n) = a_;
    rest.bottomRightCorner(n, n) = e[s];
    rest = qr.turned(rest);
    a_ = rest.bottomLeftCorner(n, n);
    e_ = rest.bottomRightCorner(n, n);
  }
}

ScaledReal CyclicDeterminant::at(double t) const {
  ScaledReal result = eliminated_;
  result *= determinant(e_ - t * a_);
  return result;
}

}  // namespace tchat

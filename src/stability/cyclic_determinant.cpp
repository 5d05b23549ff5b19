#include "stability/cyclic_determinant.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"

namespace tchat {

ScaledReal& ScaledReal::operator*=(double factor) {
  constexpr double largest = 0x1p100;
  const double product = mantissa_ * factor;
  if (std::abs(product) < largest && std::abs(product) * largest > 1.0) {  // nothing was lost
    mantissa_ = product;
    return *this;
  }
  int shift = 0;
  int factor_shift = 0;
  mantissa_ = std::frexp(mantissa_, &shift) * std::frexp(factor, &factor_shift);
  exponent_ += shift + factor_shift;
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

namespace {

/// What the upper triangle of the first columns and the reflections that it took contribute.
void multiply_by_diagonal(ScaledReal& product, int reflections, const Eigen::MatrixXd& triangle, Eigen::Index columns) {
  product *= static_cast<double>(reflections);
  for (const double entry : triangle.diagonal().head(columns)) product *= entry;
}

}  // namespace

ScaledReal determinant_in_place(Eigen::MatrixXd& matrix) {
  ScaledReal result;
  const int reflections = triangularise(matrix, matrix.cols());
  multiply_by_diagonal(result, reflections, matrix, matrix.cols());
  return result;
}

/// With W^T [e; -A_s] = [R; 0], W orthogonal, the lower rows of W^T are free of c_{s-1}: what is left of e c_{s-1} =
/// a c_0 and E_s c_s = A_s c_{s-1} there is a relation of c_s and c_0 like the first one.
void CyclicDeterminant::eliminate(const std::vector<Eigen::MatrixXd>& e, const std::vector<Eigen::MatrixXd>& a) {
  eliminated_ = {};
  e_ = e.front();
  a_ = a.front();
  const Eigen::Index n = e_.rows();
  if (n == 0 || e.size() == 1) return;
  both_.resize(2 * n, 3 * n);  // of c_{s-1}, c_0, c_s
  for (std::size_t s = 1; s < e.size(); ++s) {
    both_.topRows(n) << e_, a_, Eigen::MatrixXd::Zero(n, n);
    both_.bottomRows(n) << -a[s], Eigen::MatrixXd::Zero(n, n), e[s];
    const int reflections = triangularise(both_, n);
    multiply_by_diagonal(eliminated_, reflections, both_, n);
    a_ = both_.block(n, n, n, n);
    e_ = both_.bottomRightCorner(n, n);
  }
}

ScaledReal CyclicDeterminant::at(double t) {
  difference_ = e_ - t * a_;
  ScaledReal result = determinant_in_place(difference_);
  result *= eliminated_;
  return result;
}

}  // namespace tchat

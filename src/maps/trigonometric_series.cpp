#include "maps/trigonometric_series.hpp"

#include <cmath>
#include <complex>

#include "linear/dense_matrix.hpp"
#include "maps/circle.hpp"

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// (i 2 pi l)^order e^(2 pi i l phi) as real and imaginary parts: of a_l the real part, of b_l the imaginary one.
VectorXd basis_at(double phi, int harmonics, int order) {
  VectorXd basis(2 * harmonics + 1);
  basis(0) = order == 0 ? 1.0 : 0.0;
  const double angle = full_turn * (phi - std::floor(phi));
  const std::complex<double> turn(std::cos(angle), std::sin(angle));
  std::complex<double> value = 1.0;
  for (int l = 1; l <= harmonics; ++l) {
    value *= turn;
    std::complex<double> derived = value;
    for (int k = 0; k < order; ++k) derived *= std::complex<double>(0.0, full_turn * l);
    basis(2 * l - 1) = derived.real();
    basis(2 * l) = derived.imag();
  }
  return basis;
}

}  // namespace

VectorXd TrigonometricSeries::derivative(double phi, int order) const {
  return coefficients_ * basis_at(phi, harmonics(), order);
}

TrigonometricSeries TrigonometricSeries::fitted(const MatrixXd& values, const VectorXd& phases, int harmonics) {
  MatrixXd basis(phases.size(), 2 * harmonics + 1);
  for (Index k = 0; k < phases.size(); ++k) basis.row(k) = basis_at(phases(k), harmonics, 0).transpose();
  const MatrixXd normal = basis.transpose() * basis;
  return TrigonometricSeries(solve(normal, basis.transpose() * values.transpose()).transpose());
}

TrigonometricSeries TrigonometricSeries::through(const MatrixXd& values) {
  const Index count = values.cols();
  const auto harmonics = static_cast<int>((count - 1) / 2);
  MatrixXd coefficients = MatrixXd::Zero(values.rows(), 2 * harmonics + 1);
  for (Index k = 0; k < count; ++k)
    coefficients +=
        values.col(k) * basis_at(static_cast<double>(k) / static_cast<double>(count), harmonics, 0).transpose();
  coefficients *= 2.0 / static_cast<double>(count);
  coefficients.col(0) *= 0.5;
  return TrigonometricSeries(coefficients);
}

}  // namespace tchat

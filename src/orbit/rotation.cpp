#include "orbit/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tchat {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// Derivative of K of any order, the sum.
double kernel_sum(int harmonics, double t, int derivative) {
  const double quarter = 0.25 * derivative;  // each derivative turns the cosine by a quarter
  double sum = derivative == 0 ? 1.0 : 0.0;
  for (int k = 1; k <= harmonics; ++k) {
    const double phase = k * t;
    double factor = 2.0;
    for (int d = 0; d < derivative; ++d) factor *= turn * k;
    sum += factor * std::cos(turn * (phase - std::floor(phase) + quarter));
  }
  return sum / (2 * harmonics + 1);
}

/// K and K' in closed form, K = sin(pi N t) / (N sin(pi t)), but for t so near to a whole number that K' would lose
/// digits: there are one or two of those among N equally spaced t.
double kernel(int harmonics, double t, int derivative) {
  const int count = 2 * harmonics + 1;
  const double s = std::sin(0.5 * turn * t);
  if (derivative > 1 || std::abs(s) < 1.0 / count) return kernel_sum(harmonics, t, derivative);
  const double top = std::sin(0.5 * turn * count * t);
  if (derivative == 0) return top / (count * s);
  const double slope = count * std::cos(0.5 * turn * count * t) * s - top * std::cos(0.5 * turn * t);
  return 0.5 * turn * slope / (count * s * s);
}

}  // namespace

Eigen::RowVectorXd interpolation_weights(int count, double phi, int derivative) {
  Eigen::RowVectorXd weights(count);
  set_interpolation_weights(phi, derivative, weights);
  return weights;
}

void set_interpolation_weights(double phi, int derivative, Eigen::RowVectorXd& weights) {
  const auto count = static_cast<int>(weights.size());
  for (int l = 0; l < count; ++l)
    weights(l) = kernel((count - 1) / 2, phi - static_cast<double>(l) / count, derivative);
}

Eigen::MatrixXd resampled_curve(const Eigen::MatrixXd& values, int count) {
  const auto old_count = static_cast<int>(values.cols());
  const int harmonics = (std::min(count, old_count) - 1) / 2;
  // With the kernel of the fewer harmonics, as a mean over the old values.
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(values.rows(), count);
  for (int i = 0; i < count; ++i)
    for (int l = 0; l < old_count; ++l) {
      const double t = static_cast<double>(i) / count - static_cast<double>(l) / old_count;
      result.col(i) += kernel(harmonics, t, 0) * (2 * harmonics + 1) / old_count * values.col(l);
    }
  return result;
}

Eigen::VectorXd harmonic_sizes(const Eigen::MatrixXd& values, const Eigen::VectorXd& scale) {
  const auto count = static_cast<int>(values.cols());
  Eigen::VectorXd sizes((count + 1) / 2);
  Eigen::VectorXd cosines(count);
  Eigen::VectorXd sines(count);
  for (int k = 0; k < sizes.size(); ++k) {
    for (int l = 0; l < count; ++l) {
      const double phase = turn * static_cast<double>((k * l) % count) / count;
      cosines(l) = std::cos(phase);
      sines(l) = std::sin(phase);
    }
    const double factor = (k == 0 ? 1.0 : 2.0) / count;
    const Eigen::VectorXd a = values * cosines;
    const Eigen::VectorXd b = values * sines;
    sizes(k) = factor * ((a.cwiseAbs2() + b.cwiseAbs2()).cwiseSqrt().cwiseQuotient(scale)).maxCoeff();
  }
  return sizes;
}

}  // namespace tchat

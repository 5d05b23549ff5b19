#include "stability/grazing_response.hpp"

#include <algorithm>
#include <cmath>

#include "orbit/orbit.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A matrix or vector as digits * 2^exponent, so that powers neither vanish nor overflow.
struct ScaledMatrix {
  MatrixXd digits;
  double exponent = 0.0;

  void normalise() {
    const double size = digits.lpNorm<Eigen::Infinity>();
    if (size == 0.0 || !std::isfinite(size)) return;
    const int shift = std::ilogb(size);
    digits *= std::ldexp(1.0, -shift);
    exponent += shift;
  }
};

ScaledMatrix scaled_product(const ScaledMatrix& a, const ScaledMatrix& b) {
  ScaledMatrix result{a.digits * b.digits, a.exponent + b.exponent};
  result.normalise();
  return result;
}

/// A^n v by squaring A.
ScaledMatrix power_times(ScaledMatrix a, int n, ScaledMatrix v) {
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) v = scaled_product(a, v);
    a = scaled_product(a, a);
  }
  return v;
}

/// Of before = A^(n-1) (beta and its errors).
ImpactReturn one_more(const VectorXd& event_gradient, const MatrixXd& return_map, const ScaledMatrix& before) {
  constexpr double smallest = -900.0;  // a sign that underflow would swallow is kept, at this size
  constexpr double largest = 900.0;
  const double size = std::ldexp(1.0, static_cast<int>(std::clamp(before.exponent, smallest, largest)));
  return impact_return(event_gradient, size * before.digits, size * (return_map * before.digits));
}

}  // namespace

MatrixXd ImpactDirection::with_errors() const {
  MatrixXd columns(beta.size(), 1 + beta.size());
  columns << beta, uncertainty * MatrixXd::Identity(beta.size(), beta.size());
  return columns;
}

ImpactDirection impact_direction(const VectorXd& f, const VectorXd& section_gradient, const MatrixXd& jump_derivative) {
  const VectorXd v = jump_derivative * f;
  const double acceleration = section_gradient.dot(f);
  const double terms =
      jump_derivative.norm() * f.norm() * (1.0 + f.norm() * section_gradient.norm() / std::abs(acceleration));
  return {v - f * (section_gradient.dot(v) / acceleration), orbit_accuracy * terms};
}

ImpactReturn impact_return(const VectorXd& event_gradient, const MatrixXd& before, const MatrixXd& last) {
  const double of_powers = orbit_accuracy * std::max(before.col(0).norm(), last.col(0).norm());
  const double of_beta = last.rightCols(last.cols() - 1).norm();
  return {-event_gradient.dot(last.col(0)), event_gradient.norm() * (of_powers + of_beta)};
}

ImpactReturn impact_return(const VectorXd& event_gradient, const MatrixXd& return_map, const ImpactDirection& direction,
                           int n) {
  return one_more(event_gradient, return_map, power_times({return_map}, n - 1, {direction.with_errors()}));
}

std::vector<ImpactReturn> impact_returns(const VectorXd& event_gradient, const MatrixXd& return_map,
                                         const ImpactDirection& direction, int count) {
  std::vector<ImpactReturn> result;
  ScaledMatrix turned{direction.with_errors()};
  for (int n = 1; n <= count; ++n) {
    result.push_back(one_more(event_gradient, return_map, turned));
    turned = scaled_product({return_map}, turned);
  }
  return result;
}

}  // namespace tchat

#include "stability/grazing_response.hpp"

#include <algorithm>
#include <cmath>

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

ScaledMatrix product(const ScaledMatrix& a, const ScaledMatrix& b) {
  ScaledMatrix result{a.digits * b.digits, a.exponent + b.exponent};
  result.normalise();
  return result;
}

/// A^n v by squaring A.
ScaledMatrix power_times(ScaledMatrix a, int n, ScaledMatrix v) {
  for (; n > 0; n /= 2) {
    if (n % 2 == 1) v = product(a, v);
    a = product(a, a);
  }
  return v;
}

/// Of before = A^(n-1) beta.
ImpactReturn one_more(const VectorXd& event_gradient, const MatrixXd& return_map, const ScaledMatrix& before) {
  constexpr double smallest = -900.0;  // a sign that underflow would swallow is kept, at this size
  constexpr double largest = 900.0;
  const double size = std::ldexp(1.0, static_cast<int>(std::clamp(before.exponent, smallest, largest)));
  return impact_return(event_gradient, size * before.digits, size * (return_map * before.digits));
}

}  // namespace

VectorXd impact_direction(const VectorXd& f, const VectorXd& section_gradient, const MatrixXd& jump_derivative) {
  const VectorXd v = jump_derivative * f;
  return v - f * (section_gradient.dot(v) / section_gradient.dot(f));
}

ImpactReturn impact_return(const VectorXd& event_gradient, const VectorXd& before, const VectorXd& last) {
  return {-event_gradient.dot(last), event_gradient.norm() * std::max(before.norm(), last.norm())};
}

ImpactReturn impact_return(const VectorXd& event_gradient, const MatrixXd& return_map, const VectorXd& beta, int n) {
  return one_more(event_gradient, return_map, power_times({return_map}, n - 1, {beta}));
}

std::vector<ImpactReturn> impact_returns(const VectorXd& event_gradient, const MatrixXd& return_map,
                                         const VectorXd& beta, int count) {
  std::vector<ImpactReturn> result;
  ScaledMatrix turned{beta};
  for (int n = 1; n <= count; ++n) {
    result.push_back(one_more(event_gradient, return_map, turned));
    turned = product({return_map}, turned);
  }
  return result;
}

}  // namespace tchat

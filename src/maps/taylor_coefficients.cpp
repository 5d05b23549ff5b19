#include "maps/taylor_coefficients.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "linear/dense_matrix.hpp"

namespace tchat {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int points = 12;
constexpr int sizes = 14;

/// Chebyshev points of [-1, 1], and the matrix that makes coefficients of powers of values there.
struct UnitInterpolation {
  VectorXd nodes = VectorXd(points);
  MatrixXd to_coefficients;

  UnitInterpolation() {
    MatrixXd powers(points, points);
    for (int i = 0; i < points; ++i) {
      nodes(i) = std::cos((2 * i + 1) * std::numbers::pi / (2 * points));
      powers(i, 0) = 1.0;
      for (int k = 1; k < points; ++k) powers(i, k) = powers(i, k - 1) * nodes(i);
    }
    to_coefficients = solve(powers, MatrixXd::Identity(points, points));
  }
};

std::optional<MatrixXd> coefficients(const std::function<VectorXd(double)>& function, double size, int count,
                                     const UnitInterpolation& unit) {
  MatrixXd values;
  for (int i = 0; i < points; ++i) {
    const VectorXd value = function(size * unit.nodes(i));
    if (!value.allFinite()) return std::nullopt;
    if (i == 0) values.resize(value.size(), points);
    values.col(i) = value;
  }
  MatrixXd result = values * unit.to_coefficients.topRows(count).transpose();
  double power = 1.0;
  for (int k = 0; k < count; ++k, power *= size) result.col(k) /= power;
  return result;
}

}  // namespace

TaylorCoefficients taylor_coefficients(const std::function<VectorXd(double)>& function, double first_size, int count) {
  const UnitInterpolation unit;
  TaylorCoefficients best{{}, VectorXd::Constant(count, INFINITY)};
  std::optional<MatrixXd> before;
  double size = first_size;
  for (int trial = 0; trial < sizes; ++trial, size *= 0.5) {
    std::optional<MatrixXd> now = coefficients(function, size, count, unit);
    if (now && best.columns.size() == 0) best.columns = MatrixXd::Constant(now->rows(), count, NAN);
    for (int k = 0; now && before && k < count; ++k) {
      const double difference = (now->col(k) - before->col(k)).lpNorm<Eigen::Infinity>();
      if (!(difference < best.errors(k))) continue;
      best.errors(k) = difference;
      best.columns.col(k) = now->col(k);
    }
    before = std::move(now);
  }
  return best;
}

}  // namespace tchat

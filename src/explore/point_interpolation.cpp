#include "explore/point_interpolation.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// What the polynomial through the points first..last has at `at`, between points i and i + 1. The points are
/// parametrised by their distance, in which a branch is smooth at folds too.
VectorXd polynomial_value(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Index first,
                          Index last, Index i, double at) {
  const auto p = [&](Index k) { return coordinate[static_cast<std::size_t>(k)]; };
  const Index rows = numbers.rows();
  VectorXd distance(last - first + 1);
  distance(0) = 0.0;
  for (Index k = first; k < last; ++k) {
    const double size = numbers.cwiseAbs().maxCoeff() + std::abs(p(k));
    const double step = std::hypot((numbers.col(k + 1) - numbers.col(k)).norm(), p(k + 1) - p(k));
    distance(k + 1 - first) = distance(k - first) + std::max(step, 1e-14 * size);
  }
  const auto value = [&](double s) {
    VectorXd result = VectorXd::Zero(rows + 1);
    for (Index k = first; k <= last; ++k) {
      double weight = 1.0;
      for (Index l = first; l <= last; ++l)
        if (l != k) weight *= (s - distance(l - first)) / (distance(k - first) - distance(l - first));
      result(0) += weight * p(k);
      result.tail(rows) += weight * numbers.col(k);
    }
    return result;
  };
  double low = distance(i - first), high = distance(i + 1 - first);
  const bool rises = p(i + 1) >= p(i);
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    ((value(middle)(0) < at) == rises ? low : high) = middle;
  }
  return value(0.5 * (low + high)).tail(rows);
}

/// Of the largest number: runs leave errors far below this, and different orbits differ by far more.
constexpr double least_uncertainty = 1e-5;

}  // namespace

InterpolatedPoint interpolate(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Index i,
                              double at) {
  const auto count = static_cast<Index>(coordinate.size());
  const Index first = std::max<Index>(0, i - 1);
  const Index last = std::min<Index>(count - 1, i + 2);
  const VectorXd best = polynomial_value(coordinate, numbers, first, last, i, at);
  const bool drops_first = last - i > i - first || last == count - 1;
  const Index nearer = last - first < 2 ? first : drops_first ? first + (first < i ? 1 : 0) : first;
  const Index farther = last - first < 2 ? last : nearer > first ? last : std::max(i + 1, last - 1);
  const VectorXd other = polynomial_value(coordinate, numbers, nearer, farther, i, at);
  return {best, (best - other).cwiseAbs()};
}

bool agrees(const InterpolatedPoint& point, const VectorXd& numbers) {
  const double size = numbers.cwiseAbs().maxCoeff();
  for (Index k = 0; k < numbers.size(); ++k)
    if (!(std::abs(point.numbers(k) - numbers(k)) <= 2.0 * point.uncertainty(k) + least_uncertainty * size))
      return false;
  return true;
}

}  // namespace tchat

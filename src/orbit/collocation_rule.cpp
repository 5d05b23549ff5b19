#include "orbit/collocation_rule.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>
#include <utility>

namespace tchat {

namespace {

struct GaussRule {
  Eigen::VectorXd points;   // on [0, 1], rising
  Eigen::VectorXd weights;  // of unit sum
};

GaussRule gauss_rule(int order) {
  GaussRule rule{Eigen::VectorXd(order), Eigen::VectorXd(order)};
  const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(order);  // the zeros in [0, 1)
  int filled = 0;
  const auto add = [&](double z) {
    const double slope = boost::math::legendre_p_prime(order, z);
    rule.points(filled) = 0.5 * (1.0 + z);
    rule.weights(filled) = 1.0 / ((1.0 - z * z) * slope * slope);
    ++filled;
  };
  for (auto z = zeros.rbegin(); z != zeros.rend(); ++z)
    if (*z > 0.0) add(-*z);
  for (const double z : zeros) add(z);
  return rule;
}

/// Norm of prod (sigma - node_i) / (c+1)! over the interval; that of c + 1 equally spaced nodes is a good measure.
double interpolation_constant(int c) {
  double worst = 0.0;
  for (int k = 0; k <= 200; ++k) {
    double product = 1.0;
    for (int i = 0; i <= c; ++i) product *= k / 200.0 - static_cast<double>(i) / c;
    worst = std::max(worst, std::abs(product));
  }
  return worst / std::tgamma(c + 2.0);
}

/// The error that arises on an interval, per size of the residual at its ends.
double residual_integral_of(const Eigen::VectorXd& gauss) {
  constexpr int samples = 400;
  const auto product = [&](double sigma) { return (sigma - gauss.array()).prod(); };
  double integral = 0.0;
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    integral += product((k + 0.5) / samples) / samples;
    largest = std::max(largest, std::abs(integral));
  }
  return largest / std::abs(product(0.0));
}

}  // namespace

CollocationRule::CollocationRule(int points)
    : value(points, points + 1),
      slope(points, points + 1),
      mass(Eigen::MatrixXd::Zero(points + 1, points + 1)),
      integral(Eigen::VectorXd::Zero(points + 1)),
      highest(points + 1),
      interpolation(interpolation_constant(points)),
      end_slope(2, points + 1),
      points_(points),
      nodes_(points + 1),
      barycentric_(points + 1) {
  const int nodes = points + 1;
  for (int i = 0; i < nodes; ++i) {
    nodes_(i) = static_cast<double>(i) / points;
    double product = 1.0;
    for (int k = 0; k < nodes; ++k)
      if (k != i) product *= static_cast<double>(i - k) / points;
    barycentric_(i) = 1.0 / product;
    // The leading coefficient of l_i is its barycentric weight; its c-th derivative is that times c!.
    highest(i) = std::tgamma(points + 1.0) / product;
  }

  GaussRule rule = gauss_rule(points);
  gauss = std::move(rule.points);
  weights = std::move(rule.weights);
  Eigen::VectorXd values(nodes);
  Eigen::VectorXd slopes(nodes);
  for (int j = 0; j < points; ++j) {
    basis(gauss(j), values.data(), slopes.data());
    value.row(j) = values.transpose();
    slope.row(j) = slopes.transpose();
  }
  const Eigen::PermutationMatrix<Eigen::Dynamic> order =
      Eigen::PartialPivLU<Eigen::MatrixXd>(slope.rightCols(points)).permutationP();
  gauss = order * gauss;
  weights = order * weights;
  value = order * value;
  slope = order * slope;

  for (const int end : {0, 1}) {
    basis(end, values.data(), slopes.data());
    end_slope.row(end) = slopes.transpose();
  }
  residual_integral = residual_integral_of(gauss);

  const GaussRule exact = gauss_rule(nodes);  // exact to degree 2c + 1, the products have 2c
  for (int j = 0; j < nodes; ++j) {
    basis(exact.points(j), values.data(), nullptr);
    mass += exact.weights(j) * values * values.transpose();
    integral += exact.weights(j) * values;
  }
}

/// l_i = b_i prod_(k < i) (sigma - node_k) prod_(k > i) (sigma - node_k)
void CollocationRule::basis_values(double sigma, double* values) const {
  const int nodes = points_ + 1;
  double before = 1.0;
  for (int i = 0; i < nodes; ++i) {
    values[i] = barycentric_(i) * before;
    before *= sigma - nodes_(i);
  }
  double after = 1.0;
  for (int i = nodes - 1; i >= 0; --i) {
    values[i] *= after;
    after *= sigma - nodes_(i);
  }
}

void CollocationRule::basis(double sigma, double* values, double* slopes) const {
  if (slopes == nullptr) return basis_values(sigma, values);
  const int nodes = points_ + 1;
  for (int i = 0; i < nodes; ++i) {
    double product = barycentric_(i);
    double sum = 0.0;  // derivative of the product of (sigma - node_k)
    for (int k = 0; k < nodes; ++k) {
      if (k == i) continue;
      const double factor = sigma - nodes_(k);
      sum = sum * factor + product;
      product *= factor;
    }
    if (values != nullptr) values[i] = product;
    slopes[i] = sum;
  }
}

}  // namespace tchat

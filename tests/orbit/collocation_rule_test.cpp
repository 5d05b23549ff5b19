// Gauss points and Lagrange polynomials against exact integrals of polynomials.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "orbit/collocation_rule.hpp"

using namespace tchat;
using Eigen::VectorXd;

namespace {

/// sigma^power at the nodes.
VectorXd monomial(int c, int power) {
  VectorXd u(c + 1);
  for (int i = 0; i <= c; ++i) u(i) = std::pow(static_cast<double>(i) / c, power);
  return u;
}

constexpr double rounding = 2e-12;  // of Lagrange polynomials of degree 7

}  // namespace

TEST_CASE("Gauss points: the product of (sigma - gauss_j) is orthogonal to all polynomials of lower degree") {
  for (int c = 2; c <= 7; ++c) {
    const CollocationRule rule(c);
    REQUIRE(rule.points() == c);
    std::vector<double> coefficients{1.0};  // of the product, lowest power first
    for (int j = 0; j < c; ++j) {
      coefficients.insert(coefficients.begin(), 0.0);
      for (std::size_t k = 0; k + 1 < coefficients.size(); ++k) coefficients[k] -= rule.gauss(j) * coefficients[k + 1];
    }
    for (int power = 0; power < c; ++power) {
      double integral = 0.0;
      for (std::size_t k = 0; k < coefficients.size(); ++k)
        integral += coefficients[k] / (static_cast<double>(k) + power + 1);
      CHECK(std::abs(integral) < 1e-14);
    }
    VectorXd rising = rule.gauss;
    std::sort(rising.begin(), rising.end());
    for (int j = 0; j < c; ++j) {
      CHECK(rising(j) + rising(c - 1 - j) == Approx(1.0).epsilon(1e-15));
      if (j > 0) CHECK(rising(j) > rising(j - 1));
    }
  }
  CHECK(CollocationRule(2).gauss.minCoeff() == Approx(0.5 - 0.5 / std::sqrt(3.0)).epsilon(1e-15));
}

TEST_CASE("Gauss points: in the order of the pivots of the interior nodes") {
  for (int c = 2; c <= 7; ++c) {
    const CollocationRule rule(c);
    Eigen::MatrixXd rest = rule.slope.middleCols(1, c - 1);
    for (int k = 0; k + 1 < c; ++k) {
      for (int i = k + 1; i < c; ++i) {
        CHECK(std::abs(rest(i, k)) <= std::abs(rest(k, k)));
        rest.row(i) -= rest(i, k) / rest(k, k) * Eigen::RowVectorXd(rest.row(k));
      }
    }
  }
}

TEST_CASE("basis: Lagrange polynomials reproduce polynomials of degree c and their slopes") {
  for (int c = 2; c <= 7; ++c) {
    const CollocationRule rule(c);
    VectorXd values(c + 1), slopes(c + 1);
    for (const double sigma : {-0.1, 0.0, 0.123, 0.5, 1.0, 1.1}) {
      rule.basis(sigma, values.data(), slopes.data());
      CHECK(values.sum() == Approx(1.0).epsilon(rounding));
      CHECK(std::abs(slopes.sum()) < 100 * rounding);
      for (int power = 1; power <= c; ++power) {
        CHECK(std::abs(values.dot(monomial(c, power)) - std::pow(sigma, power)) < rounding);
        CHECK(std::abs(slopes.dot(monomial(c, power)) - power * std::pow(sigma, power - 1)) < 100 * rounding);
      }
    }
    for (int i = 0; i <= c; ++i) {
      rule.basis(static_cast<double>(i) / c, values.data(), nullptr);
      for (int k = 0; k <= c; ++k) CHECK(std::abs(values(k) - (i == k ? 1.0 : 0.0)) < rounding);
    }
  }
}

TEST_CASE("tables: values and slopes at Gauss points, exact integrals, highest derivative") {
  for (int c = 2; c <= 7; ++c) {
    const CollocationRule rule(c);
    for (int a = 0; a <= c; ++a) {
      const VectorXd u = monomial(c, a);
      for (int j = 0; j < c; ++j) {
        CHECK(std::abs(rule.value.row(j).dot(u) - std::pow(rule.gauss(j), a)) < rounding);
        CHECK(std::abs(rule.slope.row(j).dot(u) - (a == 0 ? 0.0 : a * std::pow(rule.gauss(j), a - 1))) <
              100 * rounding);
      }
      CHECK(rule.integral.dot(u) == Approx(1.0 / (a + 1)).epsilon(rounding));
      for (int b = 0; b <= c; ++b)
        CHECK(u.dot(rule.mass * monomial(c, b)) == Approx(1.0 / (a + b + 1)).epsilon(rounding));
      const double wanted = a == c ? std::tgamma(c + 1.0) : 0.0;
      CHECK(std::abs(rule.highest.dot(u) - wanted) < 1e-9 * std::tgamma(c + 1.0));
    }
  }
}

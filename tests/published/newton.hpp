/// A root of a function of several variables, for closed forms that are equations.
#pragma once

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "support/random_matrices.hpp"

namespace test_support {

/// z with defect(z) = 0, |defect(z)| < tolerance, by Newton's method from near it with central differences; `defect`
/// maps a VectorXd to one of the same length. Requires convergence.
template <class Defect>
Eigen::VectorXd newton(Eigen::VectorXd z, double tolerance, const Defect& defect) {
  constexpr double step = 1e-6;
  for (int i = 0; i < 20; ++i) {
    Eigen::MatrixXd jacobian(z.size(), z.size());
    for (Eigen::Index k = 0; k < z.size(); ++k) {
      const Eigen::VectorXd h = Eigen::VectorXd::Unit(z.size(), k) * step;
      jacobian.col(k) = (defect(z + h) - defect(z - h)) / (2.0 * step);
    }
    z -= tchat::test::solution(jacobian, defect(z));
  }
  REQUIRE(defect(z).norm() < tolerance);
  return z;
}

}  // namespace test_support

/// A smooth map by its Taylor polynomial of first or second order at a point:
///
///     z -> value + first (z - at) + 1/2 (z - at)^T second_i (z - at)
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tchat {

struct QuadraticMap {
  Eigen::VectorXd at;                   ///< N
  Eigen::VectorXd value;                ///< N
  Eigen::MatrixXd first;                ///< N x N
  std::vector<Eigen::MatrixXd> second;  ///< for each component N x N, symmetric; empty: a map of first order
  double time = 0.0;                    ///< that the flow takes from `at` to `value`

  int order() const { return second.empty() ? 1 : 2; }
  Eigen::VectorXd operator()(const Eigen::VectorXd& z) const;
  Eigen::MatrixXd derivative(const Eigen::VectorXd& z) const;
};

}  // namespace tchat

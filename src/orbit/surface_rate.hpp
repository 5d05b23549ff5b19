/// How a flow meets an event surface at one state: h and its rate h_P = h_x f, with their derivatives.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

/// Evaluation allocates nothing: the scratch is kept.
class SurfaceRate {
 public:
  /// `free_count` PAR indices are given with each evaluation.
  SurfaceRate(int dimension, int free_count);

  /// Of event function v.event under field v.field at state x. `free_parameters`: PAR indices that hp and rate_p are
  /// derivatives by. Derivatives by states that the mode of the field has not are zero.
  void evaluate(const HybridSystem& system, const IndexVector& v, const double* x, const double* par,
                const std::vector<int>& free_parameters);

  double h = 0.0;
  double rate = 0.0;  ///< h_x f
  Eigen::VectorXd hx, hp, rate_x, rate_p;

 private:
  Eigen::VectorXd f_, direction_;  // `direction_` stays zero in the parameters
  Eigen::MatrixXd fx_, fp_;
};

}  // namespace tchat

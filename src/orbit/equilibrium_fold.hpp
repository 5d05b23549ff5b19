/// Defining condition of curves of folds of equilibria: f_x is singular.
///
/// G(x, p) is the bordered solution
///
///     [ f_x  b ] [v]   [0]        [ f_x^T  c ] [w]   [0]
///     [ c'   0 ] [G] = [1],       [ b'     0 ] [G] = [1],        G = 0 exactly when f_x is singular,
///
/// and its gradient is -w^T (d f_x) v. Regular at cusps and Bogdanov-Takens points.
///
/// Count: n functions, one duration and two parameters for 1 + n rows, G and pseudo-arclength.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "orbit/orbit_condition.hpp"

namespace tchat {

class DefiningSystem;

class EquilibriumFold final : public OrbitCondition {
 public:
  EquilibriumFold(const DefiningSystem& system, const OrbitShape& shape);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// The border b, c; empty before the first evaluation.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  /// w^T f_xx v v of null vectors of unit length: zero at a cusp.
  double cusp_function() const { return cusp_; }
  /// w^T v of null vectors of unit length: zero where the eigenvalue 0 is a double one (Bogdanov-Takens).
  double multiplicity_function() const { return column_.dot(row_); }

 private:
  bool solve_bordered();
  void begin_border();

  const DefiningSystem& system_;
  std::vector<double> direction_;  // v and no change of the parameters
  Eigen::VectorXd field_;
  Eigen::MatrixXd jacobian_, by_state_, by_parameter_;
  Eigen::VectorXd column_;  // b, follows w
  Eigen::VectorXd row_;     // c, follows v
  Eigen::VectorXd v_, w_;
  bool started_ = false;
  double value_ = 0.0;
  double cusp_ = 0.0;
  OrbitVector gradient_;
};

}  // namespace tchat

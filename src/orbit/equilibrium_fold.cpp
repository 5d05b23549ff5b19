#include "orbit/equilibrium_fold.hpp"

#include <algorithm>
#include <cmath>

#include "linear/dense_matrix.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

EquilibriumFold::EquilibriumFold(const DefiningSystem& system, const OrbitShape& shape)
    : system_(system),
      direction_(static_cast<std::size_t>(shape.dimension + system.free_count()), 0.0),
      field_(shape.dimension),
      jacobian_(shape.dimension, shape.dimension),
      by_state_(shape.dimension, shape.dimension),
      by_parameter_(shape.dimension, system.free_count()),
      column_(shape.dimension),
      row_(shape.dimension),
      gradient_(shape, system.free_count()) {
  begin_border();
}

/// Any border that leaves the matrix regular.
void EquilibriumFold::begin_border() {
  for (Eigen::Index i = 0; i < column_.size(); ++i) {
    column_(i) = std::sin(1.0 + 0.7 * static_cast<double>(i));
    row_(i) = std::cos(0.3 + 0.9 * static_cast<double>(i));
  }
  column_.normalize();
  row_.normalize();
}

void EquilibriumFold::remember(std::vector<double>& memory) const {
  memory.clear();
  if (!started_) return;
  memory.insert(memory.end(), column_.begin(), column_.end());
  memory.insert(memory.end(), row_.begin(), row_.end());
}

void EquilibriumFold::recall(const std::vector<double>& memory) {
  started_ = !memory.empty();
  if (!started_) return begin_border();
  std::copy_n(memory.begin(), column_.size(), column_.begin());
  std::copy_n(memory.begin() + column_.size(), row_.size(), row_.begin());
}

bool EquilibriumFold::solve_bordered() {
  const Eigen::Index n = column_.size();
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 1, n + 1);
  bordered.topLeftCorner(n, n) = jacobian_;
  bordered.topRightCorner(n, 1) = column_;
  bordered.bottomLeftCorner(1, n) = row_.transpose();
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n + 1, n);
  const Eigen::VectorXd right = solve(bordered, unit);
  const Eigen::VectorXd left = solve(bordered.transpose(), unit);
  v_ = right.head(n);
  w_ = left.head(n);
  value_ = right(n);
  return right.allFinite() && left.allFinite();
}

bool EquilibriumFold::evaluate(CondensedSystem&, const Orbit& x) {
  const int field = system_.signature().front().field;
  const HybridSystem& problem = system_.system();
  problem.first(FunctionKind::field, field, x.end(0), x.par.data(), {}, field_.data(), jacobian_.data(), nullptr);
  // The border follows the null vectors; the first time it takes some rounds to find them.
  for (int round = started_ ? 3 : 0; round < 4; ++round) {
    if (!solve_bordered()) return false;
    column_ = w_.normalized();
    row_ = v_.normalized();
  }
  started_ = true;
  std::copy(v_.begin(), v_.end(), direction_.begin());
  problem.second(FunctionKind::field, field, x.end(0), x.par.data(), system_.free_parameters(), direction_.data(),
                 field_.data(), by_state_.data(), by_parameter_.data());
  gradient_.set_zero();
  gradient_.states.col(gradient_.states.cols() - 1) = -by_state_.transpose() * w_;
  gradient_.globals = -by_parameter_.transpose() * w_;
  cusp_ = column_.dot(by_state_ * row_) / v_.norm();
  return by_state_.allFinite() && by_parameter_.allFinite();
}

}  // namespace tchat

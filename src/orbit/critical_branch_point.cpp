#include "orbit/critical_branch_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tchat {

CriticalBranchPoint::CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape,
                                         const UnfoldedSystem* unfolded)
    : unfolded_(unfolded),
      map_(system, shape),
      multiplier_(system, shape, 1),
      extended_(shape, system.free_count()),
      gradient_(shape, system.free_count()) {
  if (unfolded_ != nullptr) next_phi_.resize(static_cast<std::size_t>(unfolded_->rows()));
  begin();
}

CriticalBranchPoint::CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape)
    : CriticalBranchPoint(system, shape, nullptr) {}

CriticalBranchPoint::CriticalBranchPoint(const UnfoldedSystem& system, const OrbitShape& shape)
    : CriticalBranchPoint(system, shape, &system) {}

/// The label is a branch point in the first parameter; any phi does that is not in the range of F_u.
void CriticalBranchPoint::begin() {
  direction_ = Eigen::VectorXd::Unit(directions(), 0);
  next_direction_ = direction_;
  columns_ = Eigen::MatrixXd::Zero(map_.size() + 1, directions());
  solutions_ = columns_;
  if (unfolded_ == nullptr) return;
  std::vector<double> any(next_phi_.size());
  for (std::size_t r = 0; r < any.size(); ++r)
    any[r] = std::sin(0.8 + 1.9 * static_cast<double>(r)) / std::sqrt(static_cast<double>(any.size()));
  unfolded_->unfold_along(any);
}

void CriticalBranchPoint::remember(std::vector<double>& memory) const {
  multiplier_.remember(memory);
  if (memory.empty()) return;
  memory.insert(memory.end(), next_direction_.begin(), next_direction_.end());
  memory.insert(memory.end(), next_phi_.begin(), next_phi_.end());
}

void CriticalBranchPoint::recall(const std::vector<double>& memory) {
  if (memory.empty()) {
    multiplier_.recall(memory);
    begin();
    return;
  }
  const auto own = static_cast<std::ptrdiff_t>(next_phi_.size()) + next_direction_.size();
  const auto middle = memory.end() - own;
  inner_memory_.assign(memory.begin(), middle);
  multiplier_.recall(inner_memory_);
  std::copy_n(middle, direction_.size(), direction_.begin());
  next_direction_ = direction_;
  std::copy(middle + direction_.size(), memory.end(), next_phi_.begin());
  if (unfolded_ != nullptr) unfolded_->unfold_along(next_phi_);
}

bool CriticalBranchPoint::evaluate(CondensedSystem& condensed, const Orbit& x) {
  if (!multiplier_.evaluate(condensed, x)) return false;
  b_ = unfolded_ != nullptr ? x.par(x.par.layout().unfolding(x.shape.segments) - 1) : 0.0;
  size_ = 1.0 + x.states.cwiseAbs().maxCoeff();
  for (int k = 0; k < directions(); ++k) {
    map_.parameter_column(condensed, x, k, columns_.col(k).data());
    multiplier_.solve_beside(columns_.col(k).data(), solutions_.col(k).data());
  }
  value_ = left_null().dot(columns_.topRows(map_.size()) * direction_);
  const Eigen::VectorXd z = solutions_ * direction_;
  if (!std::isfinite(value_) || !z.allFinite()) return false;
  extended_.globals.setZero();
  extended_.globals.head(directions()) = -direction_;
  gradient_.set_zero();
  condensed.extend(z.data(), extended_);
  map_.subtract_derivative(condensed, x, left_null().data(), std::span(&extended_, 1), gradient_);
  if (unfolded_ != nullptr) choose_next(condensed);
  return true;
}

/// What steps from here take for c, the way in which G changes along the orbits of two parameters, and phi, psi itself.
void CriticalBranchPoint::choose_next(CondensedSystem& condensed) {
  for (int k = 0; k < directions(); ++k) {
    extended_.globals.setZero();
    extended_.globals(k) = 1.0;
    const Eigen::VectorXd along = -solutions_.col(k);
    condensed.extend(along.data(), extended_);
    next_direction_(k) = dot(multiplier_.gradient(), extended_);
  }
  const double change = next_direction_.norm();
  next_direction_ = change > 0.0 ? Eigen::VectorXd(next_direction_ / change) : direction_;

  const int n = condensed.shape().dimension;
  const int block = 2 * n + 1;
  auto to = next_phi_.begin();
  for (int s = 0; s < condensed.shape().segments; ++s) {
    const int rows = unfolded_->coupling_rows(s);  // the last ones of the segment's rows of S
    to = std::copy_n(left_null().data() + (s + 1) * block - rows, rows, to);
  }
  const double norm = Eigen::Map<const Eigen::VectorXd>(next_phi_.data(), unfolded_->rows()).norm();
  for (double& entry : next_phi_) entry /= norm;
}

std::string CriticalBranchPoint::beyond_end() const {
  constexpr double zero = 1e-4;  // far more than the asymmetry of a mesh leaves of b
  if (!(std::abs(b_) > zero * size_)) return {};
  return fmt::format(
      "the branch points are branch points no longer (the unfolding parameter is {:.2e}, not 0): what makes the "
      "branches "
      "cross, a symmetry for instance, is broken here",
      b_);
}

BranchPointBreaking branch_point_breaking(const DefiningSystem& system, const Orbit& x) {
  const int parameters = system.free_count();
  const int integrals = system.integral_conditions();
  CondensedSystem condensed(system, x.shape, {parameters + integrals});
  OrbitResidual residual = condensed.make_residual();
  std::vector<OrbitVector> rows(static_cast<std::size_t>(parameters + integrals), condensed.make_vector());
  for (int k = 0; k < parameters; ++k) rows[static_cast<std::size_t>(k)].globals(k) = 1.0;
  system.integral_gradients(x, x, condensed.rule(), residual.integral.data(),
                            std::span(rows).subspan(static_cast<std::size_t>(parameters)));
  CriticalMultiplier multiplier(system, x.shape, 1);
  // Singular or not, the blocks are there.
  if (condensed.linearize(x, rows, residual) == Linearization::not_finite || !multiplier.evaluate(condensed, x))
    return {};
  constexpr double rounding = 1e-6;  // of the matrix: a smaller column says nothing
  CondensedReturnMap map(system, x.shape);
  std::vector<double> matrix;
  map.values(condensed, x, 1.0, matrix);
  const double least = rounding * Eigen::Map<const Eigen::VectorXd>(matrix.data(), std::ssize(matrix)).norm();
  Eigen::VectorXd column(map.size());
  const Eigen::Map<const Eigen::VectorXd> psi(multiplier.left_null_vector().data(), map.size());
  BranchPointBreaking result{true, {}};
  for (int k = 0; k < parameters; ++k) {
    map.parameter_column(condensed, x, k, column.data());
    column *= 1.0 + std::abs(x.par(system.free_parameters()[static_cast<std::size_t>(k)] - 1));
    result.shares.push_back(std::abs(psi.dot(column)) / (psi.norm() * (column.norm() + least)));
  }
  return result;
}

}  // namespace tchat

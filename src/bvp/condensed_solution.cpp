// The second half of CondensedSystem: solutions, extensions and the determinant from the factors that linearize() left.
#include <algorithm>
#include <cmath>

#include "bvp/condensed_system.hpp"

namespace tchat {

/// What is zero in the segments stays zero when it is condensed.
void CondensedSystem::solve(std::span<const double> border, OrbitVector& dx) {
  std::fill(rhs_.begin(), rhs_.end() - border_, 0.0);
  std::copy_n(border.data(), border_, rhs_.end() - border_);
  solve_and_expand(true, dx);
}

void CondensedSystem::solve(const OrbitResidual& residual, std::span<const double> border, OrbitVector& dx) {
  double* rhs = rhs_.data();
  double* border_rhs = rhs_.data() + lu_.size() - border_;
  std::copy_n(border.data(), border_, border_rhs);
  const double* coupling = residual.coupling.data();
  segment_work_.each(shape_.segments, [&](int s, int) {
    elimination_.condense_right_hand_side(s, &residual.collocation[index(collocation_row(s))], segment_rhs_[s]);
  });
  for (int s = 0; s < shape_.segments; ++s) {
    const double* condensed = segment_rhs_[s];
    rhs = std::copy_n(condensed, n_, rhs);
    for (int r = 0; r < system_.coupling_rows(s); ++r) *rhs++ = -*coupling++;
    for (int r = 0; r < border_; ++r) border_rhs[r] += condensed[n_ + r];
  }
  solve_and_expand(false, dx);
}

/// Of the right-hand side rhs_ and, where it is not homogeneous, those that the segments were condensed with last.
void CondensedSystem::solve_and_expand(bool homogeneous, OrbitVector& dx) {
  lu_.solve(rhs_.data(), solution_.data());
  const double* globals = solution_.data() + global_unknown(0);
  segment_work_.each(shape_.segments, [&](int s, int thread) {
    elimination_.expand(s, &solution_[index(start_unknown(s))], globals, homogeneous, dx, thread);
  });
  for (int g = 0; g < globals_; ++g) dx.globals(g) = solution_[index(global_unknown(g))];
}

void CondensedSystem::duration_block(int s, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_];
}

void CondensedSystem::parameter_block(int s, int g, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_ + 1 + g];
}

void CondensedSystem::extend(const double* small, OrbitVector& dx) {
  segment_work_.each(shape_.segments, [&](int s, int thread) {
    elimination_.expand(s, small + s * (2 * n_ + 1), dx.globals.data(), true, dx, thread);
  });
}

void CondensedSystem::extend_adjoint(const double* weights, std::vector<double>& collocation) {
  segment_work_.each(shape_.segments, [&](int s, int) {
    elimination_.expand_adjoint(s, weights + s * n_, &collocation[index(collocation_row(s))]);
  });
}

CondensedSystem::Determinant CondensedSystem::determinant() const {
  const SparseLu::Determinant ends = lu_.determinant();
  LargeProduct reciprocal;
  elimination_.divide_by_determinant(reciprocal);
  const int sign = (reciprocal.mantissa > 0.0) - (reciprocal.mantissa < 0.0);
  const double log2_size = static_cast<double>(reciprocal.exponent) + std::log2(std::abs(reciprocal.mantissa));
  return {ends.sign * sign, ends.log2_size - log2_size};
}

CondensedSystem::Singularity CondensedSystem::singularity() const {
  const SparseLu::Condition condition = lu_.condition();
  Singularity result{condition.reciprocal, make_vector()};
  if (condition.null_direction.empty()) return result;
  const double* direction = condition.null_direction.data();
  for (int s = 0; s < shape_.segments; ++s) {
    std::copy_n(direction + start_unknown(s), n_, result.direction.states.col(s * shape_.nodes()).data());
    std::copy_n(direction + end_unknown(s), n_, result.direction.states.col((s + 1) * shape_.nodes() - 1).data());
    result.direction.durations(s) = direction[duration_unknown(s)];
  }
  for (int g = 0; g < globals_; ++g) result.direction.globals(g) = direction[global_unknown(g)];
  return result;
}

}  // namespace tchat

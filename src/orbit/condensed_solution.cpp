// The second half of CondensedSystem: solutions, extensions and the determinant from the factors that linearize() left.
#include <algorithm>
#include <array>
#include <cmath>

#include "orbit/condensed_system.hpp"

namespace tchat {

void CondensedSystem::solve(std::span<const double> border, OrbitVector& dx) {
  solve_ends(border, solution_);
  expand(solution_, RightHandSide::zero, dx);
}

void CondensedSystem::solve(const OrbitResidual& residual, std::span<const double> border, OrbitVector& dx) {
  condense_right_hand_sides(residual.collocation);
  solve_ends(segment_rhs_, residual, border);
  expand(solution_, RightHandSide::condensed, dx);
}

/// Into segment_rhs_.
void CondensedSystem::condense_right_hand_sides(const std::vector<double>& collocation) {
  segment_work_.each(shape_.segments, [&](int s, int) {
    elimination_.condense_right_hand_side(s, &collocation[index(collocation_row(s))], segment_rhs_[s]);
  });
}

void CondensedSystem::null_vector(OrbitVector& v, int closing_row) {
  if (closing_ == 0) find_null_vectors();
  expand(null_ends_[index(closing_row)], RightHandSide::zero, v);
}

void CondensedSystem::solve_with_null_vectors(const OrbitResidual& linearized, std::span<const double> border,
                                              OrbitVector& dx, std::span<OrbitVector> v) {
  solve_ends(own_rhs_, linearized, border);
  if (closing_ == 0) find_null_vectors();
  const std::size_t together = std::min(v.size(), SegmentElimination::most_together - 1);
  segment_work_.each_in_reverse(shape_.segments, [&](int s, int thread) {  // as in expand()
    std::array<SegmentSolution, SegmentElimination::most_together> solutions;
    solutions[0] = in_segment(s, solution_, RightHandSide::own, dx);
    for (std::size_t z = 0; z < together; ++z)
      solutions[1 + z] = in_segment(s, null_ends_[z], RightHandSide::zero, v[z]);
    elimination_.expand_together(s, std::span(solutions).first(1 + together), thread);
  });
  for (std::size_t z = together; z < v.size(); ++z) null_vector(v[z], static_cast<int>(z));
  put_globals(solution_, dx);
  for (std::size_t z = 0; z < v.size(); ++z) put_globals(null_ends_[z], v[z]);
}

/// solution_ from the right-hand sides of the condensed rows of segments, -residual of the coupling rows, and `border`.
void CondensedSystem::solve_ends(const BlockArray<double>& condensed, const OrbitResidual& residual,
                                 std::span<const double> border) {
  double* rhs = rhs_.data();
  const double* coupling = residual.coupling.data();
  std::copy_n(border.data(), border_, border_rhs());
  for (int s = 0; s < shape_.segments; ++s) {
    rhs = std::copy_n(condensed[s], n_, rhs);
    for (int r = 0; r < system_.coupling_rows(s); ++r) *rhs++ = -*coupling++;
    for (int r = 0; r < general_; ++r) border_rhs()[closing_ + r] += condensed[s][n_ + r];
  }
  lu_.solve(rhs_.data(), solution_.data());
}

/// The same for F = 0: what is zero in the segments stays zero when it is condensed.
void CondensedSystem::solve_ends(std::span<const double> border, EndVector& ends) {
  std::fill(rhs_.begin(), rhs_.end() - border_, 0.0);
  std::copy_n(border.data(), border_, border_rhs());
  lu_.solve(rhs_.data(), ends.data());
}

/// null_ends_ from the factors.
void CondensedSystem::find_null_vectors() {
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  for (std::size_t r = 0; r < null_ends_.size(); ++r) {
    border_rhs()[r] = 1.0;
    lu_.solve(rhs_.data(), null_ends_[r].data());
    border_rhs()[r] = 0.0;
  }
}

/// From the ends of segments to all nodes. The last segments, whose blocks were made last and may still be in the
/// cache, are the first.
void CondensedSystem::expand(const EndVector& ends, RightHandSide right, OrbitVector& dx) {
  segment_work_.each_in_reverse(
      shape_.segments, [&](int s, int thread) { elimination_.expand(s, in_segment(s, ends, right, dx), thread); });
  put_globals(ends, dx);
}

SegmentSolution CondensedSystem::in_segment(int s, const EndVector& ends, RightHandSide right, OrbitVector& dx) const {
  return {right, &ends[index(start_unknown(s))], &ends[index(global_unknown(0))], &dx};
}

void CondensedSystem::put_globals(const EndVector& ends, OrbitVector& dx) const {
  for (int g = 0; g < globals_; ++g) dx.globals(g) = ends[index(global_unknown(g))];
}

void CondensedSystem::duration_block(int s, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_];
}

void CondensedSystem::parameter_block(int s, int g, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_ + 1 + g];
}

SegmentSolution CondensedSystem::beyond_ends(int s, RightHandSide right, const double* small, OrbitVector& dx) const {
  return {right, small + s * (2 * n_ + 1), dx.globals.data(), &dx};
}

void CondensedSystem::extend(const double* small, OrbitVector& dx) {
  segment_work_.each_in_reverse(shape_.segments, [&](int s, int thread) {
    elimination_.expand(s, beyond_ends(s, RightHandSide::zero, small, dx), thread);
  });
}

void CondensedSystem::condense_right_hand_side(const std::vector<double>& collocation, double* condensed) {
  condense_right_hand_sides(collocation);
  for (int s = 0; s < shape_.segments; ++s) std::copy_n(segment_rhs_[s], n_, condensed + s * n_);
}

void CondensedSystem::extend_condensed(const double* small, OrbitVector& dx) {
  segment_work_.each_in_reverse(shape_.segments, [&](int s, int thread) {
    elimination_.expand(s, beyond_ends(s, RightHandSide::condensed, small, dx), thread);
  });
}

void CondensedSystem::extend_both(const double* small, OrbitVector& dx, const double* other_small,
                                  OrbitVector& other_dx) {
  segment_work_.each_in_reverse(shape_.segments, [&](int s, int thread) {
    elimination_.expand_together(s,
                                 std::array{beyond_ends(s, RightHandSide::zero, small, dx),
                                            beyond_ends(s, RightHandSide::zero, other_small, other_dx)},
                                 thread);
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
  const SparseLu::Condition condition = lu_.condition(end_units_);
  Singularity result{condition.reciprocal, make_vector()};
  if (condition.null_direction.empty()) return result;
  const double* direction = condition.null_direction.data();
  for (int s = 0; s < shape_.segments; ++s) {
    std::copy_n(direction + start_unknown(s), n_, result.direction.states.col(shape_.first_node(s)).data());
    std::copy_n(direction + end_unknown(s), n_, result.direction.states.col(shape_.last_node(s)).data());
    result.direction.durations(s) = direction[duration_unknown(s)];
  }
  for (int g = 0; g < globals_; ++g) result.direction.globals(g) = direction[global_unknown(g)];
  return result;
}

}  // namespace tchat

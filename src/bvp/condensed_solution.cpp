// The second half of CondensedSystem: solutions, extensions and the determinant from the factors that linearize() left.
#include <algorithm>
#include <cmath>

#include "bvp/condensed_system.hpp"

namespace tchat {

void CondensedSystem::solve(std::span<const double> border, OrbitVector& dx) { solve(zero_, border, dx); }

void CondensedSystem::solve(const OrbitResidual& residual, std::span<const double> border, OrbitVector& dx) {
  double* rhs = rhs_.data();
  double* border_rhs = rhs_.data() + lu_.size() - border_;
  std::copy_n(border.data(), border_, border_rhs);
  const double* coupling = residual.coupling.data();
  for (int s = 0; s < shape_.segments; ++s) {
    condense_right_hand_side(residual, s);
    const double* condensed = segment_rhs_[s];
    rhs = std::copy_n(condensed, n_, rhs);
    for (int r = 0; r < system_.coupling_rows(s); ++r) *rhs++ = -*coupling++;
    for (int r = 0; r < border_; ++r) border_rhs[r] += condensed[n_ + r];
  }
  lu_.solve(rhs_.data(), solution_.data());
  const double* globals = solution_.data() + global_unknown(0);
  for (int s = 0; s < shape_.segments; ++s) expand_segment(s, &solution_[index(start_unknown(s))], globals, false, dx);
  for (int g = 0; g < globals_; ++g) dx.globals(g) = solution_[index(global_unknown(g))];
}

/// The right-hand sides of a piece's n condensed rows and its border rows.
double* CondensedSystem::piece_rhs(int s, int first, int last) {
  return last - first == 1 ? interval_rhs_[block(s, first)] + interval_.pivots()
                           : join_rhs_[block(s, halfway(first, last))] + n_;
}

void CondensedSystem::condense_right_hand_side(const OrbitResidual& residual, int s) {
  const int rows = interval_.rows();
  const double* collocation = &residual.collocation[index(block(s, 0) * rows)];
  for (int j = 0; j < shape_.intervals; ++j, collocation += rows) {
    const std::ptrdiff_t b = block(s, j);
    double* r = interval_rhs_[b];
    for (int i = 0; i < rows; ++i) r[i] = -collocation[i];
    std::fill_n(r + rows, border_, 0.0);
    interval_.forward(interval_blocks_[b], border_, interval_swaps_[b], r);
  }
  for (const Join& at : joins_) {
    const std::ptrdiff_t b = block(s, at.middle);
    const double* left = piece_rhs(s, at.first, at.middle);
    const double* right = piece_rhs(s, at.middle, at.last);
    double* r = join_rhs_[b];
    std::copy_n(left, n_, r);
    std::copy_n(right, n_, r + n_);
    for (int k = 0; k < border_; ++k) r[2 * n_ + k] = left[n_ + k] + right[n_ + k];
    join_.forward(join_blocks_[b], border_, join_swaps_[b], r);
  }
  std::copy_n(piece_rhs(s, 0, shape_.intervals), n_ + border_, segment_rhs_[s]);
}

/// From the ends of a segment back to its mesh nodes, joins in reverse, and on to the interior nodes.
void CondensedSystem::expand_segment(int s, const double* ends, const double* globals, bool homogeneous,
                                     OrbitVector& dx) {
  const int c = shape_.collocation;
  const int p = interval_.pivots();
  const double* start = ends;
  const double* end = ends + n_;
  const double duration = ends[2 * n_];
  dx.durations(s) = duration;
  const auto node = [&](int k) { return dx.states.col(s * shape_.nodes() + k).data(); };
  std::copy_n(start, n_, node(0));
  std::copy_n(end, n_, node(shape_.nodes() - 1));
  double* local = local_.data();
  double* join_local = join_local_.data();
  for (auto at = joins_.rbegin(); at != joins_.rend(); ++at) {
    const std::ptrdiff_t b = block(s, at->middle);
    std::copy_n(node(at->first * c), n_, join_local + n_);
    std::copy_n(node(at->last * c), n_, join_local + 2 * n_);
    join_local[3 * n_] = duration;
    std::copy_n(globals, globals_, join_local + 3 * n_ + 1);
    join_.backward(join_blocks_[b], homogeneous ? zero_rhs_.data() : join_rhs_[b], join_local);
    std::copy_n(join_local, n_, node(at->middle * c));
  }
  for (int j = 0; j < shape_.intervals; ++j) {
    const std::ptrdiff_t b = block(s, j);
    std::copy_n(node(j * c), n_, local + p);
    std::copy_n(node((j + 1) * c), n_, local + p + n_);
    local[p + 2 * n_] = duration;
    std::copy_n(globals, globals_, local + p + 2 * n_ + 1);
    interval_.backward(interval_blocks_[b], homogeneous ? zero_rhs_.data() : interval_rhs_[b], local);
    std::copy_n(local, p, node(j * c + 1));
  }
}

void CondensedSystem::duration_block(int s, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_];
}

void CondensedSystem::parameter_block(int s, int g, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[s][a * scalars_ + 1 + g];
}

void CondensedSystem::extend(const double* small, OrbitVector& dx) {
  for (int s = 0; s < shape_.segments; ++s) expand_segment(s, small + s * (2 * n_ + 1), dx.globals.data(), true, dx);
}

void CondensedSystem::extend_adjoint(const double* weights, std::vector<double>& collocation) {
  const int p = interval_.pivots();
  const int rows = interval_.rows();
  // Right-hand sides are no longer needed: their places serve as scratch.
  for (int s = 0; s < shape_.segments; ++s) {
    std::copy_n(weights + s * n_, n_, piece_rhs(s, 0, shape_.intervals));
    for (auto at = joins_.rbegin(); at != joins_.rend(); ++at) {
      const std::ptrdiff_t b = block(s, at->middle);
      double* w = join_rhs_[b];
      std::fill_n(w, n_, 0.0);
      join_.forward_transposed(join_blocks_[b], join_swaps_[b], w);
      std::copy_n(w, n_, piece_rhs(s, at->first, at->middle));
      std::copy_n(w + n_, n_, piece_rhs(s, at->middle, at->last));
    }
    for (int j = 0; j < shape_.intervals; ++j) {
      const std::ptrdiff_t b = block(s, j);
      double* own = &collocation[index(b * rows)];
      std::fill_n(own, p, 0.0);
      std::copy_n(piece_rhs(s, j, j + 1), n_, own + p);
      interval_.forward_transposed(interval_blocks_[b], interval_swaps_[b], own);
    }
  }
}

CondensedSystem::Determinant CondensedSystem::determinant() const {
  SparseLu::Determinant product = lu_.determinant();
  const auto multiply = [&](const BlockKernel& kernel, const double* block, const int* swaps) {
    double mantissa = 1.0;
    for (int k = 0; k < kernel.pivots(); ++k) {
      mantissa *= block[k * kernel.width() + k] * (swaps[k] == k ? 1.0 : -1.0);
      int exponent = 0;
      mantissa = std::frexp(mantissa, &exponent);
      product.log2_size -= exponent;  // the blocks hold reciprocal pivots
    }
    product.sign *= (mantissa > 0.0) - (mantissa < 0.0);
    product.log2_size -= std::log2(std::abs(mantissa));
  };
  const std::ptrdiff_t blocks = block(shape_.segments, 0);
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    multiply(interval_, interval_blocks_[b], interval_swaps_[b]);
    if (b % shape_.intervals != 0) multiply(join_, join_blocks_[b], join_swaps_[b]);
  }
  return {product.sign, product.log2_size};
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

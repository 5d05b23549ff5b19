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
  const double* end = residual.end.data();
  for (int s = 0; s < shape_.segments; ++s) {
    condense_right_hand_side(residual, s);
    const double* condensed = &segment_rhs_[index(s * (n_ + border_))];
    rhs = std::copy_n(condensed, n_, rhs);
    for (int r = 0; r < system_.end_conditions(s); ++r) *rhs++ = -*end++;
    for (int a = 0; a < n_; ++a) *rhs++ = -residual.connection[index(s * n_ + a)];
    for (int r = 0; r < border_; ++r) border_rhs[r] += condensed[n_ + r];
  }
  lu_.solve(rhs_.data(), solution_.data());
  const double* globals = solution_.data() + global_unknown(0);
  for (int s = 0; s < shape_.segments; ++s) expand_segment(s, &solution_[index(start_unknown(s))], globals, false, dx);
  for (int g = 0; g < globals_; ++g) dx.globals(g) = solution_[index(global_unknown(g))];
}

void CondensedSystem::condense_right_hand_side(const OrbitResidual& residual, int s) {
  const int rows = interval_.rows();
  const int p = interval_.pivots();
  const double* collocation = &residual.collocation[index(block(s, 0) * rows)];
  double* result = &segment_rhs_[index(s * (n_ + border_))];
  for (int j = 0; j < shape_.intervals; ++j, collocation += rows) {
    const std::ptrdiff_t b = block(s, j);
    double* r = &interval_rhs_[index(b * (rows + border_))];
    for (int i = 0; i < rows; ++i) r[i] = -collocation[i];
    std::fill_n(r + rows, border_, 0.0);
    interval_.forward(&interval_blocks_[index(b * (rows + border_) * interval_.width())], border_,
                      &interval_swaps_[index(b * p)], r);
    if (j == 0) {
      std::copy_n(r + p, n_, result);
      std::copy_n(r + rows, border_, result + n_);
      continue;
    }
    double* chain = &chain_rhs_[index(b * (2 * n_ + border_))];
    std::copy_n(result, n_, chain);
    std::copy_n(r + p, n_, chain + n_);
    for (int k = 0; k < border_; ++k) chain[2 * n_ + k] = result[n_ + k] + r[rows + k];
    chain_.forward(&chain_blocks_[index(b * (2 * n_ + border_) * chain_.width())], border_,
                   &chain_swaps_[index(b * n_)], chain);
    std::copy_n(chain + n_, n_ + border_, result);
  }
}

/// From the ends of a segment back to its mesh nodes, right to left, and on to the interior nodes.
void CondensedSystem::expand_segment(int s, const double* ends, const double* globals, bool homogeneous,
                                     OrbitVector& dx) {
  const int c = shape_.collocation;
  const int p = interval_.pivots();
  const int rows = interval_.rows();
  const double* start = ends;
  const double* end = ends + n_;
  const double duration = ends[2 * n_];
  dx.durations(s) = duration;
  const auto node = [&](int k) { return dx.states.col(s * shape_.nodes() + k).data(); };
  std::copy_n(start, n_, node(0));
  std::copy_n(end, n_, node(shape_.nodes() - 1));
  double* local = local_.data();
  double* chain_local = chain_local_.data();
  for (int j = shape_.intervals - 1; j >= 0; --j) {
    const std::ptrdiff_t b = block(s, j);
    if (j > 0) {
      std::copy_n(start, n_, chain_local + n_);
      std::copy_n(node((j + 1) * c), n_, chain_local + 2 * n_);
      chain_local[3 * n_] = duration;
      std::copy_n(globals, globals_, chain_local + 3 * n_ + 1);
      chain_.backward(&chain_blocks_[index(b * (2 * n_ + border_) * chain_.width())],
                      homogeneous ? zero_rhs_.data() : &chain_rhs_[index(b * (2 * n_ + border_))], chain_local);
      std::copy_n(chain_local, n_, node(j * c));
    }
    std::copy_n(node(j * c), n_, local + p);
    std::copy_n(node((j + 1) * c), n_, local + p + n_);
    local[p + 2 * n_] = duration;
    std::copy_n(globals, globals_, local + p + 2 * n_ + 1);
    interval_.backward(&interval_blocks_[index(b * (rows + border_) * interval_.width())],
                       homogeneous ? zero_rhs_.data() : &interval_rhs_[index(b * (rows + border_))], local);
    std::copy_n(local, p, node(j * c + 1));
  }
}

void CondensedSystem::duration_block(int s, double* column) const {
  for (int a = 0; a < n_; ++a) column[a] = scalar_blocks_[index((s * n_ + a) * scalars_)];
}

void CondensedSystem::extend(const double* small, OrbitVector& dx) {
  for (int s = 0; s < shape_.segments; ++s) expand_segment(s, small + s * (2 * n_ + 1), zero_rhs_.data(), true, dx);
  dx.globals.setZero();
}

void CondensedSystem::extend_adjoint(const double* weights, std::vector<double>& collocation) {
  const int p = interval_.pivots();
  const int rows = interval_.rows();
  double* chain = chain_rhs_.data();  // scratch: right-hand sides are no longer needed
  for (int s = 0; s < shape_.segments; ++s) {
    std::copy_n(weights + s * n_, n_, chain + n_);
    for (int j = shape_.intervals - 1; j >= 0; --j) {
      const std::ptrdiff_t b = block(s, j);
      double* own = &collocation[index(b * rows)];
      std::fill_n(own, rows, 0.0);
      if (j > 0) {
        std::fill_n(chain, n_, 0.0);
        chain_.forward_transposed(&chain_blocks_[index(b * (2 * n_ + border_) * chain_.width())],
                                  &chain_swaps_[index(b * n_)], chain);
        std::copy_n(chain + n_, n_, own + p);
        std::copy_n(chain, n_, chain + n_);
      } else {
        std::copy_n(chain + n_, n_, own + p);
      }
      interval_.forward_transposed(&interval_blocks_[index(b * (rows + border_) * interval_.width())],
                                   &interval_swaps_[index(b * p)], own);
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
  const int interval_size = (interval_.rows() + border_) * interval_.width();
  const int chain_size = (chain_.rows() + border_) * chain_.width();
  for (std::ptrdiff_t b = 0; b < blocks; ++b) {
    multiply(interval_, &interval_blocks_[index(b * interval_size)], &interval_swaps_[index(b * interval_.pivots())]);
    if (b % shape_.intervals != 0)
      multiply(chain_, &chain_blocks_[index(b * chain_size)], &chain_swaps_[index(b * chain_.pivots())]);
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

#include "linear/block_kernel.hpp"

#include "linear/partial_lu.hpp"

namespace tchat {

namespace {

/// Sizes known when compiled; Dynamic takes them from the kernel.
template <int Rows, int Pivots, int Width>
struct Fixed {
  static FixedSizes<Rows, Pivots, Width> sizes(const BlockKernel&) { return {}; }
};
struct Dynamic {
  static DynamicSizes sizes(const BlockKernel& k) { return {k.rows(), k.pivots(), k.width()}; }
};

}  // namespace

template <class Choice>
void BlockKernel::use() {
  eliminate_ = [](const BlockKernel& k, double* a, int border, int* swaps) {
    return tchat::eliminate(Choice::sizes(k), a, border, swaps);
  };
  forward_ = [](const BlockKernel& k, const double* a, int border, const int* swaps, double* rhs) {
    tchat::forward(Choice::sizes(k), a, border, swaps, rhs);
  };
  forward_transposed_ = [](const BlockKernel& k, const double* a, const int* swaps, double* weights) {
    tchat::forward_transposed(Choice::sizes(k), a, swaps, weights);
  };
  backward_ = [](const BlockKernel& k, const double* a, const double* rhs, double* x) {
    tchat::backward(Choice::sizes(k), a, rhs, x);
  };
}

/// Interval blocks of dimension N with C collocation points for one or two free parameters, and (C = 0) the blocks of
/// joins.
template <int N, int C>
bool BlockKernel::try_sizes() {
  constexpr int rows = C == 0 ? 2 * N : C * N;
  constexpr int pivots = C == 0 ? N : (C - 1) * N;
  constexpr int narrow = padded(pivots + 2 * N + 2);
  constexpr int wide = padded(pivots + 2 * N + 3);
  if (rows_ != rows || pivots_ != pivots) return false;
  if (width_ == narrow) return use<Fixed<rows, pivots, narrow>>(), true;
  if (width_ == wide) return use<Fixed<rows, pivots, wide>>(), true;
  return false;
}

BlockKernel::BlockKernel(int rows, int pivots, int width) : rows_(rows), pivots_(pivots), width_(width) {
  use<Dynamic>();
  const bool fixed = try_sizes<2, 0>() || try_sizes<3, 0>() || try_sizes<4, 0>() || try_sizes<5, 0>() ||
                     try_sizes<6, 0>() || try_sizes<2, 3>() || try_sizes<2, 4>() || try_sizes<2, 5>() ||
                     try_sizes<3, 3>() || try_sizes<3, 4>() || try_sizes<3, 5>() || try_sizes<4, 2>() ||
                     try_sizes<4, 3>() || try_sizes<4, 4>() || try_sizes<4, 5>() || try_sizes<5, 2>() ||
                     try_sizes<5, 3>() || try_sizes<5, 4>() || try_sizes<5, 5>() || try_sizes<6, 4>();
  static_cast<void>(fixed);
}

BlockKernel interval_kernel(int n, int c, int scalars) { return {c * n, (c - 1) * n, padded((c + 1) * n + scalars)}; }

BlockKernel join_kernel(int n, int scalars) { return {2 * n, n, padded(3 * n + scalars)}; }

}  // namespace tchat

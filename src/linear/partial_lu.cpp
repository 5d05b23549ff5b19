#include "linear/partial_lu.hpp"

#include <utility>

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

SmallLu::SmallLu(int size)
    : size_(size),
      entries_(at(size * size)),
      scaled_(at(size * size)),
      row_sums_(at(size)),
      right_(at(size)),
      change_(at(size)),
      swaps_(at(size)) {}

bool SmallLu::factorize() {
  double* entry = entries_.data();
  for (int i = 0; i < size_; ++i, entry += size_) {
    double sum = 0.0;
    for (int j = 0; j < size_; ++j) sum += std::abs(entry[j]);
    if (!(sum > 0.0) || !std::isfinite(sum)) return false;
    row_sums_[at(i)] = sum;
    for (int j = 0; j < size_; ++j) entry[j] /= sum;
  }
  scaled_ = entries_;
  if (!eliminate(DynamicSizes{size_, size_, size_}, entries_.data(), 0, swaps_.data())) return false;
  return std::all_of(entries_.begin(), entries_.end(), [](double value) { return std::isfinite(value); });
}

void SmallLu::apply_inverse(double* right, double* x) const {
  const DynamicSizes sizes{size_, size_, size_};
  forward(sizes, entries_.data(), 0, swaps_.data(), right);
  backward(sizes, entries_.data(), right, x);
}

/// P S = L U, where S are the scaled rows: S^T x = U^T L^T P x.
void SmallLu::apply_inverse_transposed(const double* b, double* x) const {
  std::copy_n(b, size_, x);
  for (int k = 0; k < size_; ++k) {
    const double known = x[k] *= row(k)[k];
    for (int i = k + 1; i < size_; ++i) x[i] -= row(k)[i] * known;
  }
  for (int k = size_ - 1; k > 0; --k)
    for (int i = 0; i < k; ++i) x[i] -= row(k)[i] * x[k];
  for (int k = size_ - 1; k >= 0; --k) std::swap(x[k], x[swaps_[at(k)]]);
}

void SmallLu::solve_unrefined(const double* b, double* x) {
  for (int i = 0; i < size_; ++i) right_[at(i)] = b[i] / row_sums_[at(i)];
  apply_inverse(right_.data(), x);
}

void SmallLu::solve_transposed_unrefined(const double* b, double* x) {
  apply_inverse_transposed(b, x);
  for (int i = 0; i < size_; ++i) x[i] /= row_sums_[at(i)];
}

void SmallLu::solve(const double* b, double* x) {
  solve_unrefined(b, x);
  const double* entry = scaled_.data();
  for (int i = 0; i < size_; ++i, entry += size_) {
    double rest = b[i] / row_sums_[at(i)];
    for (int j = 0; j < size_; ++j) rest -= entry[j] * x[j];
    right_[at(i)] = rest;
  }
  apply_inverse(right_.data(), change_.data());
  for (int i = 0; i < size_; ++i) x[i] += change_[at(i)];
}

void SmallLu::solve_transposed(const double* b, double* x) {
  apply_inverse_transposed(b, x);
  std::copy_n(b, size_, right_.data());
  const double* entry = scaled_.data();
  for (int i = 0; i < size_; ++i, entry += size_)
    for (int j = 0; j < size_; ++j) right_[at(j)] -= entry[j] * x[i];
  apply_inverse_transposed(right_.data(), change_.data());
  for (int i = 0; i < size_; ++i) x[i] = (x[i] + change_[at(i)]) / row_sums_[at(i)];
}

double SmallLu::pivot(int k) const { return 1.0 / row(k)[k]; }

int SmallLu::parity() const {
  int sign = 1;
  for (int k = 0; k < size_; ++k) sign = swaps_[at(k)] == k ? sign : -sign;
  return sign;
}

}  // namespace tchat

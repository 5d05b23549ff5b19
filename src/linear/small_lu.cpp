#include "linear/small_lu.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/partial_lu.hpp"

namespace tchat {

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

#include "bvp/closing_rows.hpp"

#include <algorithm>
#include <cmath>

namespace tchat {

namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// v -= its share of the unit vector `u`.
void take_out(const std::vector<double>& u, std::vector<double>& v) {
  const double share = dot(u, v);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] -= share * u[i];
}

/// Its length before.
double make_unit(std::vector<double>& v) {
  const double length = std::sqrt(dot(v, v));
  for (double& entry : v) entry /= length;
  return length;
}

}  // namespace

ClosingRows::ClosingRows(int count, int length)
    : rows_(static_cast<std::size_t>(count), std::vector<double>(static_cast<std::size_t>(length))), basis_(rows_) {
  forget();
}

void ClosingRows::forget() {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    for (std::size_t i = 0; i < rows_[k].size(); ++i)
      rows_[k][i] =
          std::sin(0.5 + static_cast<double>(k) + (0.61 + 0.27 * static_cast<double>(k)) * static_cast<double>(i));
    make_unit(rows_[k]);
  }
}

/// With unit rows W, null vectors R, W R = 1, and R = Q S, S triangular, W Q = S^-1.
double ClosingRows::follow(std::span<const std::vector<double>> null_vectors) {
  double squares = 0.0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    std::vector<double>& v = basis_[k];
    v = null_vectors[k];
    squares = std::max(squares, dot(v, v));
    for (int twice = 0; twice < 2; ++twice)
      for (std::size_t i = 0; i < k; ++i) take_out(basis_[i], v);
    if (const double length = make_unit(v); !(length > 0.0) || !std::isfinite(length)) return 0.0;
  }
  rows_ = basis_;
  return 1.0 / std::sqrt(squares);
}

}  // namespace tchat

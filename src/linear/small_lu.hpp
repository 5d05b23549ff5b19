/// Dense LU of one small matrix after the other: what is left of a Newton matrix of few segments has ten rows, and a
/// sparse solver's bookkeeping would take ten times as long as its arithmetic. All arrays are allocated when the object
/// is made.
#pragma once

#include <cstddef>
#include <vector>

namespace tchat {

class SmallLu {
 public:
  explicit SmallLu(int size);

  /// The entries that factorize() reads, row by row.
  double* entries() { return entries_.data(); }
  /// Of the matrix with rows of unit sum (of magnitudes), with row pivoting; the entries are then its factors. False
  /// when it is singular or not finite.
  bool factorize();

  /// x = A^-1 b, or A^-T b, refined once: near a branch point, where A is almost singular, the residual stays that of
  /// rounding. x and b are different arrays.
  void solve(const double* b, double* x);
  void solve_transposed(const double* b, double* x);
  /// The same as the factors give it, for iterations that need no more.
  void solve_unrefined(const double* b, double* x);
  void solve_transposed_unrefined(const double* b, double* x);

  /// Pivot k, which is never zero, and the number that its row of A was divided by: their product over all k is the
  /// determinant, but for the sign that parity() is.
  double pivot(int k) const;
  double row_sum(int k) const { return row_sums_[at(k)]; }
  int parity() const;

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  const double* row(int i) const { return entries_.data() + i * size_; }
  void apply_inverse(double* right, double* x) const;               // of the scaled matrix
  void apply_inverse_transposed(const double* b, double* x) const;  // of the scaled matrix

  int size_;
  std::vector<double> entries_;  // after factorize() L below the diagonal, reciprocal pivots on it, U above
  std::vector<double> scaled_;   // the matrix with rows of unit sum
  std::vector<double> row_sums_;
  std::vector<double> right_, change_;  // scratch
  std::vector<int> swaps_;              // the row exchanged with row k
};

}  // namespace tchat

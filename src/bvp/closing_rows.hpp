/// Rows that close a linear system with fewer equations than unknowns, so that it can be factored: with d more unknowns
/// than equations any d rows serve that tell the null vectors apart, best the null vectors themselves. Those are known
/// from the last system, which resembles this one.
///
/// What is solved with such rows is corrected afterwards: to any solution null vectors may be added (BorderedProblem).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace tchat {

class ClosingRows {
 public:
  /// `count` rows of `length` numbers, about orthogonal to nothing. Allocates all space.
  ClosingRows(int count, int length);

  int count() const { return static_cast<int>(rows_.size()); }
  const std::vector<double>& row(int k) const { return rows_[static_cast<std::size_t>(k)]; }

  /// Any rows, as they were in the beginning.
  void forget();

  /// `null_vectors` (count() vectors of length()) solve the system that the rows close, each with a one in its own row
  /// and zero in the others. The rows become an orthonormal basis of what these span, if they are finite. How well the
  /// rows before told them apart: 1 when they spanned the same, 0 when some null vector was orthogonal to all of them.
  double follow(std::span<const std::vector<double>> null_vectors);

 private:
  std::vector<std::vector<double>> rows_;
  std::vector<std::vector<double>> basis_;  // scratch
};

}  // namespace tchat

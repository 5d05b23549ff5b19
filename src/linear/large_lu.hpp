/// LU of large dense matrices, and permutations.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace tchat {

/// Sign of a permutation of 0, 1, ..., by its cycles.
inline int permutation_parity(std::vector<int> order) {
  int sign = 1;
  for (std::size_t k = 0; k < order.size(); ++k)
    while (order[k] != static_cast<int>(k)) {
      std::swap(order[k], order[static_cast<std::size_t>(order[k])]);
      sign = -sign;
    }
  return sign;
}

// Gaussian elimination with row pivoting of large square matrices, one after the other, by Eigen's blocks of columns.
//
// Where unknowns have entries in no more equations than they are, these are a matrix of their own, for the others are
// found without them: of a torus, the values of a state on which no other one depends. With J for them and R for the
// rest,
//
//     A_RR x_R = b_R,     A_JJ x_J = b_J - A_JR x_R.
//
// So such a state costs what it would cost alone, not what it adds to the third power of the size.

class LargeLu {
 public:
  explicit LargeLu(int size);
  ~LargeLu();
  LargeLu(const LargeLu&) = delete;
  LargeLu& operator=(const LargeLu&) = delete;
  LargeLu(LargeLu&&) noexcept;
  LargeLu& operator=(LargeLu&&) noexcept;

  /// Of size x size entries, row by row. False where a pivot is zero or not finite: then nothing may be solved.
  bool factorize(const double* entries);
  /// b becomes A^-1 b, or A^-T b.
  void solve(double* b);
  void solve_transposed(double* b);
  /// Its sign and the logarithm to base 2 of its magnitude.
  std::pair<int, double> determinant() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tchat

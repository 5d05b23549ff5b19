/// UMFPACK for a sequence of square sparse matrices of one pattern: the symbolic analysis is made once, the numeric
/// factorisation once per matrix. Matrices of few rows are factored as dense ones (partial_lu.hpp), those of a long
/// chain or ring of groups of rows by frontal matrices (frontal_lu.hpp); both without allocation, and much faster where
/// most of the work would be a sparse solver's bookkeeping.
#pragma once

#include <memory>
#include <span>
#include <vector>

namespace tchat {

class SparseLu {
 public:
  /// The most rows of a matrix that is factored as a dense one.
  static constexpr int most_dense_rows = 30;

  /// The pattern: entry k of the values given to `factorize` stands at (row[k], column[k]); repeated positions add up.
  /// `groups`: of the rows, if there are any (FrontalLu). Throws std::invalid_argument when a position is out of range.
  /// A structurally singular pattern shows in factorize().
  SparseLu(int size, const std::vector<int>& rows, const std::vector<int>& columns,
           const std::vector<int>& groups = {});
  ~SparseLu();
  SparseLu(const SparseLu&) = delete;
  SparseLu& operator=(const SparseLu&) = delete;
  SparseLu(SparseLu&&) noexcept;
  SparseLu& operator=(SparseLu&&) noexcept;

  int size() const;

  /// False when the matrix is exactly singular or not finite; then nothing may be solved.
  bool factorize(const std::vector<double>& values);

  /// x = A^-1 b, or A^-T b. x and b are different arrays of size() entries.
  void solve(const double* b, double* x);
  void solve_transposed(const double* b, double* x);

  /// sign * 2^log2_size; sign 0 when singular.
  struct Determinant {
    int sign = 0;
    double log2_size = 0.0;
  };
  Determinant determinant() const;

  /// Estimate of the smallest singular value as a share of the largest, of the matrix scaled to rows and columns of
  /// unit size: the relative distance to a singular matrix. Near one it is as exact as rounding allows. From the
  /// factors; 0 without them. `units`: in which the unknowns are of size 1, size() or none.
  double singular_distance(std::span<const double> units = {}) const;

  /// Estimate of the reciprocal 2-norm condition of the matrix scaled to rows and columns of unit size, with the
  /// right singular direction (in the unscaled unknowns) that goes with the smallest singular value. Allocates.
  struct Condition {
    double reciprocal = 0.0;
    std::vector<double> null_direction;
  };
  Condition condition(std::span<const double> units = {}) const;

 private:
  struct State;
  bool factorize_sparse();
  std::unique_ptr<State> state_;
};

}  // namespace tchat

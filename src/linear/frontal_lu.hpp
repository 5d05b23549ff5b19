/// LU of sparse matrices by frontal matrices.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "linear/large_lu.hpp"
#include "linear/memory.hpp"

namespace tchat {

// LU of a sparse matrix whose rows come in groups along a chain or a ring, by frontal matrices [I. S. Duff, J. K.
// Reid, SIAM J. Sci. Stat. Comput. 5 (1984) 633].
//
// A frontal matrix is a dense block of the rows of neighbouring groups. As soon as all rows are together in which a
// column has entries, the column is eliminated with pivoting among the rows there (partial_lu.hpp), and what is left
// of the rows goes into the frontal matrix of twice as many groups: halves are made from their halves, as with the
// mesh intervals of a segment, and for the same reason (segment_elimination.hpp). The last one has what is left, the
// border rows among it; these may have entries in all columns, are eliminated on the way and never chosen as pivots
// before. Where a group touches its neighbours only, work is linear in the number of groups.
//
// Where groups are coupled by rows that are long (those of a torus: the end of one return against the starts of all),
// each of these is written with one column more,
//
//     sum over near columns a_rj x_j + y_r = b_r,     y_r = sum over far columns a_rj x_j,
//
// and y_r, like the far columns, is kept to the last front, where the sum takes its place. So a group is reduced to its
// far columns and its y for itself, and the last front is factored as a large dense matrix (large_lu.hpp).
//
// Rows are divided by their sums of magnitudes first. After construction only the large matrix allocates.

class FrontalLu {
 public:
  /// The pattern is given as to SparseLu; `groups` has for each row of the matrix the number of its group, 0, 1, ...
  /// along the chain, or `border_row`. Nothing where columns are shared by groups so far apart that the blocks would be
  /// much larger than the matrix, unless long rows alone share them.
  static std::optional<FrontalLu> make(int size, std::span<const int> rows, std::span<const int> columns,
                                       std::span<const int> groups);
  static constexpr int border_row = -1;

  /// False when the columns of a frontal matrix are nearly dependent, which they may be where the matrix is far from
  /// singular (not those of the last one: there it is the matrix that is); or when a value is not finite.
  bool factorize(std::span<const double> values);

  /// x = A^-1 b, or A^-T b. x and b are different arrays.
  void solve(const double* b, double* x);
  void solve_transposed(const double* b, double* x);

  /// Its sign and the logarithm to base 2 of its magnitude, from the factors.
  std::pair<int, double> determinant() const;

 private:
  class Plan;
  /// Entry number `value` of those given to factorize() belongs at `place` of the block; `one` of no entry but y_r's.
  struct Entry {
    int value, place;
  };
  static constexpr int one = -1;
  /// The far entries of a row, at their columns of the last front; y_r is column size + its number.
  struct LongRow {
    int row;
    std::ptrdiff_t first;  // of its values
    std::vector<Entry> far;
  };
  /// What the rows that a front has left are in the front that takes them: its columns there.
  struct Child {
    int front;
    std::vector<int> columns;
  };
  struct Front {
    std::vector<Child> children;  // whose rows come first, then
    std::vector<int> own_rows;
    std::vector<int> columns;  // those eliminated here first; from `size` on those of long rows
    std::vector<Entry> entries;
    int rows = 0, border = 0, pivots = 0, width = 0;
    std::ptrdiff_t block = 0, right = 0, swaps = 0;  // where its own begin
    int left() const { return rows - pivots; }
  };

  FrontalLu() = default;
  static std::optional<FrontalLu> make_with(Plan& plan, int size, std::span<const int> rows);
  int parity() const;
  int find_parity_without_exchanges() const;
  /// Those that are eliminated in place.
  std::span<const Front> by_swaps() const { return std::span(fronts_).first(fronts_.size() - (last_ ? 1 : 0)); }
  void add_far(double factor, const LongRow& row, double* target) const;
  void find_far_sums(const double* x);
  void solve_last(double* x);
  void fetch_front(std::size_t number) const;
  void put_children(const Front& front, double* block) const;
  bool eliminate_pivots(const Front& front, double* block);
  void gather_right(const Front& front, const double* b, double* right) const;
  void scatter_weights(const Front& front, const double* weights, double* x);

  int size_ = 0;
  std::vector<Front> fronts_;  // each after its children
  std::vector<LongRow> long_rows_;
  std::optional<LargeLu> last_;  // of the last front, where rows are long
  std::vector<int> entry_rows_;
  std::vector<double> scales_;                                     // of rows
  std::vector<double, AlignedAllocator<double>> blocks_, rights_;  // of fronts
  std::vector<double> local_, known_, column_sizes_, far_values_;  // known_: y follow
  std::vector<int> swaps_;
  int parity_without_exchanges_ = 1;
};

}  // namespace tchat

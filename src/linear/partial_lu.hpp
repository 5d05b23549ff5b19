/// Dense LU of small matrices: partial elimination of blocks, with compiled code for common sizes, and whole matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tchat {

// Partial LU elimination of a small dense row-major block, the kernel of condensation (5.30-5.47).
//
// A block has `rows` + `border` rows and `width` columns. The first `pivots` columns are eliminated with partial
// pivoting among the first `rows` rows; border rows (integral conditions, gradients that stand for those of a curve's
// condition) are eliminated too but never chosen as pivot rows. In place: afterwards the first `pivots` rows hold U
// and what it couples to, the multipliers stand below the diagonal, and the remaining rows hold the Schur complement.
//
// The sizes are a template parameter, so that small common sizes compile to unrolled code: FixedSizes, or
// DynamicSizes for all others. Columns are updated four pivots at a time, so that every entry right of the pivots is
// read and written once per four pivots.

template <int Rows, int Pivots, int Width>
struct FixedSizes {
  static constexpr int rows = Rows, pivots = Pivots, width = Width;
};

struct DynamicSizes {
  int rows, pivots, width;
};

/// Row lengths are rounded up to this many doubles.
inline constexpr int row_padding = 4;
constexpr int padded(int columns) { return (columns + row_padding - 1) / row_padding * row_padding; }

namespace detail {

inline constexpr int panel = 4;

/// target[from..width) -= sum over r < Count of l[r] * source_r[from..width).
template <int Count, class Sizes>
inline void subtract_rows(const Sizes& sizes, double* __restrict target, const double* l,
                          const double* __restrict source, int from) {
  const int width = sizes.width;
  double factor[Count];
  for (int r = 0; r < Count; ++r) factor[r] = l[r];
  for (int j = from; j < width; ++j) {
    double sum = factor[0] * source[j];
    for (int r = 1; r < Count; ++r) sum += factor[r] * source[r * width + j];
    target[j] -= sum;
  }
}

}  // namespace detail

/// Eliminates; swaps[k] is the row exchanged with row k. The diagonal then holds the reciprocal pivots. False when a
/// pivot is zero or not finite: the block is then useless.
template <class Sizes>
bool eliminate(const Sizes& sizes, double* a, int border, int* swaps) {
  const int rows = sizes.rows, pivots = sizes.pivots, width = sizes.width;
  const int all_rows = rows + border;
  for (int k0 = 0; k0 < pivots; k0 += detail::panel) {
    const int k1 = std::min(k0 + detail::panel, pivots);
    for (int k = k0; k < k1; ++k) {
      int pivot_row = k;
      double largest = std::abs(a[k * width + k]);
      for (int i = k + 1; i < rows; ++i) {
        const double candidate = std::abs(a[i * width + k]);
        if (candidate > largest) largest = candidate, pivot_row = i;
      }
      if (!(largest > 0.0) || !std::isfinite(largest)) return false;
      swaps[k] = pivot_row;
      if (pivot_row != k) std::swap_ranges(a + k * width, a + (k + 1) * width, a + pivot_row * width);
      const double inverse = a[k * width + k] = 1.0 / a[k * width + k];
      for (int i = k + 1; i < all_rows; ++i) {
        const double l = (a[i * width + k] *= inverse);
        for (int j = k + 1; j < k1; ++j) a[i * width + j] -= l * a[k * width + j];
      }
    }
    for (int k = k0 + 1; k < k1; ++k)
      for (int r = k0; r < k; ++r) detail::subtract_rows<1>(sizes, a + k * width, a + k * width + r, a + r * width, k1);
    if (k1 - k0 == detail::panel) {
      for (int i = k1; i < all_rows; ++i)
        detail::subtract_rows<detail::panel>(sizes, a + i * width, a + i * width + k0, a + k0 * width, k1);
    } else {
      for (int i = k1; i < all_rows; ++i)
        for (int r = k0; r < k1; ++r)
          detail::subtract_rows<1>(sizes, a + i * width, a + i * width + r, a + r * width, k1);
    }
  }
  return true;
}

namespace detail {

/// Sum of a[j] b[j] in four running sums: strict order would make every term wait for the one before.
inline double dot(const double* a, const double* b, int count) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0};
  int j = 0;
  for (; j + 4 <= count; j += 4)
    for (int l = 0; l < 4; ++l) sum[l] += a[j + l] * b[j + l];
  for (; j < count; ++j) sum[0] += a[j] * b[j];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

}  // namespace detail

/// Applies the exchanges and multipliers of an eliminated block to a right-hand side of rows + border entries: the
/// first `pivots` entries become those of U, the others the condensed right-hand side.
template <class Sizes>
void forward(const Sizes& sizes, const double* a, int border, const int* swaps, double* rhs) {
  const int pivots = sizes.pivots, width = sizes.width;
  const int all_rows = sizes.rows + border;
  for (int k = 0; k < pivots; ++k) std::swap(rhs[k], rhs[swaps[k]]);
  // Column by column, so that no entry waits for the others of its row.
  for (int k = 0; k < pivots; ++k) {
    const double known = rhs[k];
    for (int i = k + 1; i < pivots; ++i) rhs[i] -= a[i * width + k] * known;
  }
  for (int i = pivots; i < all_rows; ++i) rhs[i] -= detail::dot(a + i * width, rhs, pivots);
}

/// The transpose of `forward` without border rows (or with them counted among sizes.rows): weights of the rows that
/// `forward` leaves (of the condensed ones alone, where the first `pivots` entries are zero) become the weights of the
/// original rows, so that weighted sums agree.
template <class Sizes>
void forward_transposed(const Sizes& sizes, const double* a, const int* swaps, double* weights) {
  const int pivots = sizes.pivots, width = sizes.width;
  for (int i = sizes.rows - 1; i > 0; --i) {
    const double* row = a + i * width;
    for (int k = 0; k < std::min(i, pivots); ++k) weights[k] -= row[k] * weights[i];
  }
  for (int k = pivots - 1; k >= 0; --k) std::swap(weights[k], weights[swaps[k]]);
}

/// Back-substitution: x[0..pivots) from rhs[0..pivots) and the known x[pivots..width); x beyond the block's own columns
/// must be zero.
template <class Sizes>
void backward(const Sizes& sizes, const double* a, const double* __restrict rhs, double* __restrict x) {
  const int pivots = sizes.pivots, width = sizes.width;
  for (int k = 0; k < pivots; ++k) x[k] = rhs[k] - detail::dot(a + k * width + pivots, x + pivots, width - pivots);
  for (int k = pivots - 1; k >= 0; --k) {
    const double known = x[k] *= a[k * width + k];
    for (int i = 0; i < k; ++i) x[i] -= a[i * width + k] * known;
  }
}

// Partial LU behind one type: a block size chosen at run time, with compiled-in code for the common ones.

class BlockKernel {
 public:
  /// rows x width block whose first `pivots` columns are eliminated; width must be a multiple of row_padding.
  BlockKernel(int rows, int pivots, int width);

  int rows() const { return rows_; }
  int pivots() const { return pivots_; }
  int width() const { return width_; }

  /// See the functions of these names above.
  bool eliminate(double* a, int border, int* swaps) const { return eliminate_(*this, a, border, swaps); }
  void forward(const double* a, int border, const int* swaps, double* rhs) const {
    forward_(*this, a, border, swaps, rhs);
  }
  void forward_transposed(const double* a, const int* swaps, double* weights) const {
    forward_transposed_(*this, a, swaps, weights);
  }
  void backward(const double* a, const double* rhs, double* x) const { backward_(*this, a, rhs, x); }

 private:
  template <class Choice>
  void use();
  template <int N, int C>
  bool try_sizes();

  int rows_;
  int pivots_;
  int width_;
  bool (*eliminate_)(const BlockKernel&, double*, int, int*);
  void (*forward_)(const BlockKernel&, const double*, int, const int*, double*);
  void (*forward_transposed_)(const BlockKernel&, const double*, const int*, double*);
  void (*backward_)(const BlockKernel&, const double*, const double*, double*);
};

/// The kernel that condenses one mesh interval of c collocation points in dimension n with k scalar unknowns
/// (duration and free parameters): rows c n, columns (interior nodes | left node | right node | scalars).
BlockKernel interval_kernel(int n, int c, int scalars);

/// The kernel that joins two neighbouring condensed blocks: 2n rows, columns (middle | first | last | scalars).
BlockKernel join_kernel(int n, int scalars);

// Dense LU of one small matrix after the other: what is left of a Newton matrix of few segments has ten rows, and a
// sparse solver's bookkeeping would take ten times as long as its arithmetic. All arrays are allocated when the object
// is made.

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

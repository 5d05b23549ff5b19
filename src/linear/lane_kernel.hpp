/// partial_lu.hpp for four blocks of one size side by side: each occupies one lane of the processor's vector registers
/// and has pivots of its own.
///
/// Entry (i, j) of the block in lane l is a[(i stride + j) lanes + l], entry i of its right-hand side r[i lanes + l].
/// The functions are compiled for several kinds of processors, one of which is chosen when the program runs. In each
/// lane all of them do the same operations in the same order, products and sums rounded separately (no fused
/// multiply-add), so that results do not depend on the processor to the last bit, nor on the blocks in other lanes.
/// Four lanes, not eight: a segment of few intervals would leave most of eight empty, and a block of dimension 4 with 4
/// collocation points would outgrow the first cache.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "linear/memory.hpp"

namespace tchat {

inline constexpr int lanes = 4;

using LaneArray = std::vector<double, AlignedAllocator<double>>;

/// Sets of instructions that the functions are compiled for.
enum class VectorSet {
  baseline,  ///< what every x86-64 processor has, or whatever else the compiler's target is
  avx2,
  avx512,  ///< AVX-512F and VL: two entries of a row in one register where pivot rows are subtracted in wide blocks
};

/// Those that this processor has, the best one last.
std::vector<VectorSet> available_vector_sets();

struct LaneFunctions;

/// `next`, where it is not null, is a block of the same sizes that the same is done to next: meanwhile it is brought
/// into the cache. Nothing else depends on it.
class LaneKernel {
 public:
  /// rows x width blocks whose first `pivots` columns are eliminated.
  LaneKernel(int rows, int pivots, int width) : LaneKernel(rows, pivots, width, available_vector_sets().back()) {}
  LaneKernel(int rows, int pivots, int width, VectorSet set);

  int rows() const { return rows_; }
  int pivots() const { return pivots_; }
  int width() const { return width_; }
  /// From one row of a block to the next, in entries: the width, or more where columns are taken in pairs.
  int stride() const { return stride_; }
  /// How many numbers a block has, with its border rows.
  std::ptrdiff_t block_size(int border) const { return static_cast<std::ptrdiff_t>(rows_ + border) * stride_ * lanes; }

  /// Bit l of the result is set when the block in lane l has a pivot that is zero or not finite; that block is then
  /// useless, the others are not touched by it. swaps[k lanes + l] is the row exchanged with row k in lane l.
  unsigned eliminate(double* a, int border, int* swaps, const double* next = nullptr) const;
  void forward(const double* a, int border, const int* swaps, double* rhs, const double* next = nullptr) const;
  void forward_transposed(const double* a, const int* swaps, double* weights) const;
  void backward(const double* a, const double* rhs, double* x, const double* next = nullptr) const;
  /// Two or more solutions for right-hand sides that are zero, as if each was found by backward().
  void backward_of_several(const double* a, std::span<double* const> x, const double* next = nullptr) const;

 private:
  int rows_;
  int pivots_;
  int width_;
  int stride_;
  const LaneFunctions* functions_;
};

/// The collocation rows of four mesh intervals of one segment, one in each lane.
struct LaneCollocation {
  int n;                      ///< dimension
  int c;                      ///< collocation points
  int scalars;                ///< columns of the duration and of the free parameters
  const double* value;        ///< c x (c + 1), column-major: the basis at the Gauss points
  const double* slope;        ///< and its derivatives
  const double* f;            ///< c n entries of `lanes` numbers: the field at the Gauss points
  const double* fx;           ///< c times n x n, column-major
  const double* fp;           ///< c times n x (scalars - 1)
  double h[lanes];            ///< lengths of the intervals
  double scale[lanes];        ///< times the duration
  const double* derivatives;  ///< of the polynomials at the Gauss points: c n entries of `lanes` numbers
};

/// The condensed rows of two neighbouring pieces, in each lane: columns (first node | last node | scalars), and those
/// of the border.
struct LanePiece {
  const double* rows;
  const double* border;
  int stride;  ///< from one row to the next, in entries
};

/// The rows that couple two pieces.
struct LaneJoin {
  int n;        ///< dimension
  int scalars;  ///< columns that are not those of nodes
  int border;
  int stride;  ///< from one row of the join to the next, in entries
};

/// The work around the elimination that is done in lanes as well.
class LaneAssembly {
 public:
  LaneAssembly() : LaneAssembly(available_vector_sets().back()) {}
  explicit LaneAssembly(VectorSet set);

  /// `count` numbers of one array for each lane to entries of `lanes` numbers.
  void gather(const double* const (&from)[lanes], int count, double* to) const;
  /// And back, but for lanes whose array is null.
  void scatter(const double* from, int count, double* const (&to)[lanes]) const;

  /// The polynomials through c + 1 nodes of n entries of `lanes` numbers at c Gauss points, and their derivatives by
  /// the intervals' own variable: c n entries of `lanes` numbers each.
  void interpolate(const LaneCollocation& at, const double* nodes, double* points, double* derivatives) const;

  /// The c n rows of the blocks, `stride` entries from one to the next, columns (interior nodes | left node | right
  /// node | T, p | residual), and the residual once more, c n entries of `lanes` numbers. `jacobian` is scratch of
  /// n n lanes numbers. False when a value is not finite in some lane.
  bool fill(const LaneCollocation& at, int stride, double* blocks, double* jacobian, double* residual) const;

  /// The 2 n rows and the border rows of a join: columns (middle node | first node | last node | scalars).
  void join(const LaneJoin& at, const LanePiece& left, const LanePiece& right, double* target) const;

 private:
  const LaneFunctions* functions_;
};

}  // namespace tchat

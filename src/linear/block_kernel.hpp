/// partial_lu.hpp behind one type: a block size chosen at run time, with compiled-in code for the common ones.
#pragma once

namespace tchat {

class BlockKernel {
 public:
  /// rows x width block whose first `pivots` columns are eliminated; width must be a multiple of row_padding.
  BlockKernel(int rows, int pivots, int width);

  int rows() const { return rows_; }
  int pivots() const { return pivots_; }
  int width() const { return width_; }

  /// See partial_lu.hpp.
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

}  // namespace tchat

/// The linearised boundary value problem of an orbit, condensed and factored.
///
/// At an orbit x the linearisation of the collocation equations (5.29) and of the coupling rows, bordered by b rows,
/// reads J dx = -F. It is reduced in two sweeps that touch every mesh interval once:
///   1. interval: the c - 1 interior nodes are eliminated from the c n collocation rows; n rows in (left, right)
///   remain;
///   2. joins: neighbouring pieces are joined by elimination of the mesh node between them with pivoting, halves of a
///   segment from their halves, until n rows per segment remain,
///          A_s x_s(0) + C_s x_s(1) + B_s (T_s, p) = r_s                                   (5.48-5.49 with C_s kept)
///   The order matters. From left to right the same elimination becomes a product of transfer matrices wherever the
///   flow grows little per interval: every pivot is then an entry of the longer piece, rounding grows like the flow
///   over the whole segment, up to 2^(n N), and decaying modes are lost [S. J. Wright, SIAM J. Sci. Comput. 14 (1993)
///   231]. Pieces of equal length show their growth to the pivot search; rounding grows by 2^n for each of the log2 N
///   levels at most, by little in practice;
/// and UMFPACK solves what is left, 2 n m + m + q unknowns that couple only neighbouring segments. Work and memory
/// are linear in m and N. All arrays are allocated when the object is made.
///
/// Border rows are general linear functionals of the unknowns, given as dual vectors.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bvp/collocation_rule.hpp"
#include "bvp/coupling.hpp"
#include "bvp/defining_system.hpp"
#include "bvp/orbit.hpp"
#include "linear_algebra/block_array.hpp"
#include "linear_algebra/block_kernel.hpp"
#include "linear_algebra/sparse_lu.hpp"

namespace tchat {

/// F at an orbit, the conditions of the branch excepted.
struct OrbitResidual {
  std::vector<double> collocation;  ///< m N c n: segment, interval, Gauss point, component; scaled by the interval
  std::vector<double> coupling;     ///< the coupling rows, group by group
  std::vector<double> integral;     ///< the integral conditions

  double largest() const;
  bool finite() const;
};

/// Outcome of a linearisation; factors exist only when it is `ready`. `condition_lost`: the condition of a
/// two-parameter curve cannot be evaluated.
enum class Linearization { ready, not_finite, singular, condition_lost };

class CondensedSystem {
 public:
  /// `border_rows` = b, integral conditions among them. The defining system must outlive this object; its coupling rows
  /// and the border are as many as the ends, durations and free parameters leave open: n m + m + q.
  CondensedSystem(const DefiningSystem& system, const OrbitShape& shape, int border_rows);

  const DefiningSystem& system() const { return system_; }
  const OrbitShape& shape() const { return shape_; }
  const CollocationRule& rule() const { return rule_; }
  int border_rows() const { return border_; }
  OrbitResidual make_residual() const;
  OrbitVector make_vector() const { return OrbitVector(shape_, system_.free_count()); }

  /// F(x). The result may hold entries that are not finite.
  void evaluate(const Orbit& x, OrbitResidual& residual);

  /// J(x) bordered by `rows` (b dual vectors), factored; F(x) on the way, but for the integral conditions, whose
  /// gradients are among the rows.
  Linearization linearize(const Orbit& x, std::span<const OrbitVector> rows, OrbitResidual& residual);

  /// The solution of J dx = -F, rows dx = border. `border` has b entries; the integral conditions of `residual` are not
  /// read.
  void solve(const OrbitResidual& residual, std::span<const double> border, OrbitVector& dx);
  /// The same with F = 0.
  void solve(std::span<const double> border, OrbitVector& dx);

  /// Row-major n x n blocks A_s and C_s: on every segment a flow perturbation satisfies A_s v(0) + C_s v(1) = 0.
  const double* first_block(int s) const { return first_blocks_[s]; }
  const double* last_block(int s) const { return last_blocks_[s]; }

  /// Effect (n) of the duration's change on the condensed rows of segment s: A_s v(0) + C_s v(1) + duration_block
  /// sigma.
  void duration_block(int s, double* column) const;

  /// The same (n) of the change of free problem parameter g.
  void parameter_block(int s, int g, double* column) const;

  /// From the ends of segments to all nodes: `small` has v_s(0), v_s(1), sigma_s of every segment (m (2n + 1) numbers);
  /// dx becomes the vector that has these ends and dx.globals, and satisfies the linearised collocation equations.
  void extend(const double* small, OrbitVector& dx);
  /// The adjoint: `weights` (m n) of the condensed rows to weights of all collocation rows (as OrbitResidual orders
  /// them), so that the weighted sum of the latter is that of the former for every vector that `extend` gives.
  void extend_adjoint(const double* weights, std::vector<double>& collocation);

  /// The determinant of the bordered J as sign * 2^log2_size; sign 0 when it is singular. Its sign does not depend on
  /// the mesh, its size does.
  struct Determinant {
    int sign = 0;
    double log2_size = 0.0;
  };
  Determinant determinant() const;

  /// The determinant's sign times the relative distance of the condensed matrix, scaled to rows and columns of unit
  /// size, to a singular one: it has the zeros of the determinant, but its size depends neither on the mesh nor on how
  /// much the flow contracts. 0 when singular. Allocates.
  double signed_distance() const { return determinant().sign * lu_.singular_distance(); }

  /// Scaled reciprocal condition of the factored matrix and its null direction, of which only the ends of segments,
  /// durations and globals are filled in. Allocates.
  struct Singularity {
    double reciprocal_condition = 0.0;
    OrbitVector direction;
  };
  Singularity singularity() const;

 private:
  static std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }
  /// Number of an interval's blocks.
  std::ptrdiff_t block(int s, int j) const { return static_cast<std::ptrdiff_t>(s) * shape_.intervals + j; }
  EndUnknowns unknowns() const { return {n_, shape_.segments}; }
  int start_unknown(int s) const { return unknowns().start(s); }
  int end_unknown(int s) const { return unknowns().end(s); }
  int duration_unknown(int s) const { return unknowns().duration(s); }
  int global_unknown(int g) const { return unknowns().global(g); }

  /// The elimination of mesh node `middle` joins intervals first..middle-1 to intervals middle..last-1; its block is
  /// the one of interval `middle`.
  struct Join {
    int first, middle, last;
  };
  /// The n condensed rows and the border rows of some neighbouring intervals: columns (first node | last node |
  /// scalars) begin at `rows` and `border`.
  struct Piece {
    const double* rows;
    const double* border;
    int width;
  };

  static std::vector<Join> joins_of_halves(int intervals);
  static int halfway(int first, int last) { return first + (last - first) / 2; }
  SparseLu make_sparse();
  template <class Dimension>
  void interpolate(Dimension n, const Orbit& x, int s, int j, int gauss_point);
  template <class Dimension>
  bool fill_interval_of(Dimension n, const Orbit& x, int s, int j, double* block, double* collocation);
  Linearization condense_segment(const Orbit& x, int s, std::span<const OrbitVector> rows, double* collocation);
  bool fill_interval(const Orbit& x, int s, int j, double* block, double* collocation);
  void fill_border(int s, int j, std::span<const OrbitVector> rows, double* block) const;
  Piece piece(int s, int first, int last) const;
  bool join(int s, const Join& at);
  void keep_segment_blocks(int s);
  bool assemble(const Orbit& x, std::span<const OrbitVector> rows, OrbitResidual& residual);
  double* piece_rhs(int s, int first, int last);
  void condense_right_hand_side(const OrbitResidual& residual, int s);
  void expand_segment(int s, const double* ends, const double* globals, bool homogeneous, OrbitVector& dx);

  const DefiningSystem& system_;
  OrbitShape shape_;
  int n_;
  int globals_;  // q
  int scalars_;  // duration and globals: 1 + q columns
  int border_;   // b
  CollocationRule rule_;
  BlockKernel interval_;
  BlockKernel join_;
  std::vector<Join> joins_;  // each after those that make its two pieces

  // of intervals
  BlockArray<double> interval_blocks_;  // (c n + b) x width
  BlockArray<int> interval_swaps_;
  BlockArray<double> join_blocks_;  // (2 n + b) x width
  BlockArray<int> join_swaps_;
  BlockArray<double> interval_rhs_;
  BlockArray<double> join_rhs_;
  // of segments
  BlockArray<double> first_blocks_;   // n x n
  BlockArray<double> last_blocks_;    // n x n
  BlockArray<double> scalar_blocks_;  // n x scalars
  BlockArray<double> border_blocks_;  // b x (2 n + scalars): first | last | scalars
  BlockArray<double> segment_rhs_;    // n + b

  std::vector<int> triplet_rows_;  // before lu_, whose constructor needs them
  std::vector<int> triplet_columns_;
  std::vector<double> triplet_values_;
  SparseLu lu_;
  std::vector<double> rhs_;
  std::vector<double> solution_;

  // scratch of one collocation point or one end of a segment
  std::vector<double> x_, slope_, f_, fx_, scaled_, fp_, local_, join_local_;
  OrbitResidual zero_;
  std::vector<double> zero_rhs_;  // of one block
};

}  // namespace tchat

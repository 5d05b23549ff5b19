/// The linearised boundary value problem of an orbit, condensed and factored.
///
/// At an orbit x the linearisation of the collocation equations (5.29) and of the coupling rows, bordered by b rows,
/// reads J dx = -F. Each segment is reduced to n rows in its ends, its duration and the free parameters
/// (segment_elimination.hpp), and SparseLu solves what is left, 2 n m + m + q unknowns that couple only neighbouring
/// segments. Work and memory are linear in m and N. All arrays are allocated when the object is made; orbits whose
/// segments have meshes of their own may have their intervals dealt out otherwise than the one linearised before.
///
/// Border rows are general linear functionals of the unknowns, given as dual vectors. Each takes part in the
/// elimination of every interval, but for closing rows, which have entries at the ends of segments alone, for durations
/// and free parameters, and cost nothing there. They serve to find the vectors that all other rows annihilate, the null
/// vectors. A single closing row is given, and stands unless its value on the null vector is a small difference of
/// large terms, or zero; then, and where there are several, an orthonormal basis of the null vectors' ends closes the
/// matrix. What a general row is to say is said with a closing row and one more solution (BorderedProblem).
///
/// Where there is enough work for several threads, they share it by segments, or within each segment where there are
/// few of these. What is left for SparseLu one thread does. Results are the same to the last bit for any number.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "linear/array_kernel.hpp"
#include "linear/memory.hpp"
#include "linear/sparse_lu.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"
#include "orbit/segment_elimination.hpp"

namespace tchat {

/// F at an orbit, the conditions of the branch excepted.
struct OrbitResidual {
  std::vector<double> collocation;  ///< m N c n: segment, interval, Gauss point, component; scaled by the interval
  std::vector<double> coupling;     ///< the coupling rows, group by group
  std::vector<double> integral;     ///< the integral conditions
  ArrayRange of_collocation{};      ///< of those entries, also where they are not kept

  double largest() const;
  bool finite() const;
};

/// Rows of the border: closing ones, and after them general ones.
struct BorderRows {
  int general = 0;
  int closing = 0;
  int all() const { return general + closing; }
};

/// A vector or row of what is left between the segments: first node, last node and duration of each of them, then the
/// free parameters.
using EndVector = std::vector<double>;

class CondensedSystem {
 public:
  /// `border` = b rows, integral conditions among them. The defining system must outlive this object; its coupling rows
  /// and the border are as many as the ends, durations and free parameters leave open: n m + m + q.
  /// As many threads as `threads` may work on it, the calling one among them, which alone calls the problem.
  CondensedSystem(const DefiningSystem& system, const OrbitShape& shape, BorderRows border, int threads = 1);

  const DefiningSystem& system() const { return system_; }
  /// That of the orbit linearised last.
  const OrbitShape& shape() const { return shape_; }
  const CollocationRule& rule() const { return rule_; }
  int border_rows() const { return border_; }
  /// How the work is shared; by one thread alone where there is little.
  const EliminationThreads& threads() const { return threads_; }
  OrbitResidual make_residual() const;
  /// Without entries for the collocation rows: linearize() then keeps nothing of them but their range.
  OrbitResidual make_residual_of_ends() const;
  OrbitVector make_vector() const { return OrbitVector(shape_, system_.free_count()); }
  EndVector make_end_vector() const { return EndVector(index(lu_.size())); }

  /// F(x). The result may hold entries that are not finite.
  void evaluate(const Orbit& x, OrbitResidual& residual);

  /// J(x) bordered by these rows, the general ones given as dual vectors, and factored; F(x) on the way, but for the
  /// integral conditions, whose gradients are among the general rows. `closing`: the row where a single one closes,
  /// else nothing. Where it gives way, its right-hand side is that of what takes its place.
  Linearization linearize(const Orbit& x, std::span<const EndVector> closing, std::span<const OrbitVector> general,
                          OrbitResidual& residual);
  /// The same without closing rows.
  Linearization linearize(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual) {
    return linearize(x, {}, general, residual);
  }

  /// Its first part alone, for what is asked of segments below: their collocation rows eliminated, with the residual of
  /// these.
  Linearization condense(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual);

  /// The solution of J dx = -F, rows dx = border. `border` has b entries; the integral conditions of `residual` are not
  /// read.
  void solve(const OrbitResidual& residual, std::span<const double> border, OrbitVector& dx);
  /// The same with F = 0.
  void solve(std::span<const double> border, OrbitVector& dx);
  /// The solution for F = 0 and a one in the first border row, or in another closing row.
  void null_vector(OrbitVector& v, int closing_row = 0);
  /// Both at once, which takes little more than one: dx for the residual that linearize() found and `border`, and the
  /// null vectors of the first closing rows.
  void solve_with_null_vectors(const OrbitResidual& linearized, std::span<const double> border, OrbitVector& dx,
                               std::span<OrbitVector> v);

  /// Do null vectors close the matrix of the last linearisation? Always where there are several closing rows.
  bool closing_rows_gave_way() const { return closing_rows_gave_way_; }

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
  /// Two at once, to the last bit what each is alone.
  void extend_both(const double* small, OrbitVector& dx, const double* other_small, OrbitVector& other_dx);
  /// Right-hand sides -collocation of the collocation rows (as OrbitResidual orders them) to those of the condensed
  /// rows, m n numbers.
  void condense_right_hand_side(const std::vector<double>& collocation, double* condensed);
  /// As extend(), but dx satisfies the collocation rows with the right-hand sides condensed last.
  void extend_condensed(const double* small, OrbitVector& dx);
  /// The adjoint: `weights` (m n) of the condensed rows to weights of all collocation rows (as OrbitResidual orders
  /// them), so that the weighted sum of the latter is that of the former for every vector that `extend` gives.
  void extend_adjoint(const double* weights, std::vector<double>& collocation);

  /// The determinant of the bordered J as sign * 2^log2_size; sign 0 when it is singular. Its sign does not depend on
  /// the mesh but for that of the closing rows on the null vectors, its size does.
  struct Determinant {
    int sign = 0;
    double log2_size = 0.0;
  };
  Determinant determinant() const;

  /// The determinant's sign times the relative distance of the condensed matrix, scaled to rows and columns of unit
  /// size, to a singular one: it has the zeros of the determinant, but its size depends neither on the mesh nor on how
  /// much the flow contracts. 0 when singular. Allocates.
  double signed_distance() const {
    return lu_.determinant().sign * elimination_.determinant_sign() * lu_.singular_distance(end_units_);
  }

  /// Scaled reciprocal condition of the factored matrix and its null direction, of which only the ends of segments,
  /// durations and globals are filled in. Allocates.
  struct Singularity {
    double reciprocal_condition = 0.0;
    OrbitVector direction;
  };
  Singularity singularity() const;

 private:
  static std::size_t index(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }
  /// Where the collocation residual of segment s begins; beyond the last one, how long it is.
  std::ptrdiff_t collocation_row(int s) const {
    return static_cast<std::ptrdiff_t>(shape_.first_interval(s)) * shape_.collocation * n_;
  }
  EndUnknowns unknowns() const { return {n_, shape_.segments}; }
  int start_unknown(int s) const { return unknowns().start(s); }
  int end_unknown(int s) const { return unknowns().end(s); }
  int duration_unknown(int s) const { return unknowns().duration(s); }
  int global_unknown(int g) const { return unknowns().global(g); }

  void adopt(const OrbitShape& shape);
  SparseLu make_sparse();
  template <class Dimension>
  void interpolate(Dimension n, const Orbit& x, int s, int j, int gauss_point);
  double* collocation_of(int s, OrbitResidual& residual) const;
  Linearization condense_one_by_one(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual);
  Linearization condense_together(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual);
  void keep_segment_blocks(int s);
  bool assemble(const Orbit& x, std::span<const OrbitVector> general, OrbitResidual& residual);
  bool factorize(std::span<const EndVector> closing);
  void choose_units(const Orbit& x);
  bool close_along_null_vectors(bool known);
  bool factorize_with(std::span<const EndVector> closing);
  void condense_right_hand_sides(const std::vector<double>& collocation);
  void find_null_vectors();
  double* put_general_row(int r, const OrbitVector& row, double* value) const;
  double* border_rhs() { return rhs_.data() + lu_.size() - border_; }
  void solve_ends(const BlockArray<double>& condensed, const OrbitResidual& residual, std::span<const double> border);
  void solve_ends(std::span<const double> border, EndVector& ends);
  SegmentSolution in_segment(int s, const EndVector& ends, RightHandSide right, OrbitVector& dx) const;
  void expand(const EndVector& ends, RightHandSide right, OrbitVector& dx);
  SegmentSolution beyond_ends(int s, RightHandSide right, const double* small, OrbitVector& dx) const;
  void put_globals(const EndVector& ends, OrbitVector& dx) const;

  const DefiningSystem& system_;
  OrbitShape shape_;
  int n_;
  int globals_;  // q
  int scalars_;  // duration and globals: 1 + q columns
  int border_;   // b
  int closing_;  // of these
  int general_;  // the others
  CollocationRule rule_;
  EliminationThreads threads_;
  SharedWork segment_work_;
  SegmentElimination elimination_;
  std::vector<Linearization> outcomes_;  // of segments

  // of segments
  BlockArray<double> first_blocks_;   // n x n
  BlockArray<double> last_blocks_;    // n x n
  BlockArray<double> scalar_blocks_;  // n x scalars
  BlockArray<double> border_blocks_;  // of general rows, g x (2 n + scalars): first | last | scalars
  BlockArray<double> own_rhs_;        // n + g: of the residual that linearize() found
  BlockArray<double> segment_rhs_;    // n + g: of any

  std::vector<int> triplet_rows_;  // before lu_, whose constructor needs them
  std::vector<int> triplet_columns_;
  std::vector<double> triplet_values_;
  SparseLu lu_;
  std::ptrdiff_t closing_place_ = 0;  // of closing rows, in triplet_values_
  bool closing_rows_gave_way_ = false;
  std::vector<EndVector> closing_rows_;  // where others than those given stand
  EndVector end_units_;                  // of the unknowns at the ends, see choose_units()
  std::optional<bool> has_usual_time_;   // of the first orbit: a unit that came and went would jump
  EndVector rhs_;
  EndVector solution_;                // what SparseLu sees of dx
  std::vector<EndVector> null_ends_;  // and of null vectors: one for each closing row, known after linearize()

  std::vector<double> x_, slope_;  // scratch of one collocation point
};

}  // namespace tchat

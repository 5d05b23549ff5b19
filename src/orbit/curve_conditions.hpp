/// Defining conditions of curves of bifurcations of periodic orbits: one critical multiplier, a critical pair, a branch
/// point, two events at once.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "linear/sparse_lu.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/return_map.hpp"
#include "orbit/ring_system.hpp"

namespace tchat {

// Defining condition of fold and period-doubling curves: the orbit has the multiplier mu = +1 or -1 (5.11-5.22).
//
// The augmented hybrid system asks for v with v' = T f_x v + sigma f on each segment, h_x v_s(1) = 0,
// v_{s+1}(0) = g_x v_s(1) and mu v_1(0) = g_x v_m(1) at the end: sigma_s, the change of the duration, replaces the
// division by h_x f of (5.13), so that nothing is singular at grazing. Instead of continuing v as n m further
// functions, G(x) is the bordered solution of the same linear problem condensed to the ends of segments,
//
//     [ S  b ] [v]   [0]          [ S^T  c ] [w]   [0]
//     [ c' 0 ] [G] = [1],         [ b'   0 ] [G] = [1],            G = 0 exactly when S is singular,
//
// and its gradient is -w^T (dS) v. S shares the condensed blocks of the Newton matrix: a curve costs one more small
// sparse factorisation, two solutions and one sweep of second derivatives for each Newton matrix.

/// A condition that keeps a real multiplier.
class RealMultiplierCondition : public OrbitCondition {
 public:
  /// w_1(0)-row times v_1(0) of its null vectors: zero where the multiplier is a double one (1:1 and 1:2 resonance).
  virtual double multiplicity_function() const = 0;
};

class CriticalMultiplier final : public RealMultiplierCondition {
 public:
  /// `multiplier` is 1 or -1.
  CriticalMultiplier(const DefiningSystem& system, const OrbitShape& shape, int multiplier);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// The border b, c; empty before the first evaluation.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  std::optional<int> kept_multiplier() const override { return multiplier_; }
  bool put_critical_vectors(CriticalVectors& vectors) const override;
  /// The null vector v with the sigma_s as durations, of unit size at the ends of segments.
  const OrbitVector& null_vector() const { return v_; }
  double multiplicity_function() const override { return multiplicity_; }
  /// dG in the direction of the null vector: zero at a cusp of a fold curve.
  double cusp_function() const { return dot(gradient_, v_); }

  // Of the last evaluation, at the ends of segments, in the unknowns of CondensedReturnMap:
  /// w, its size() entries first.
  const std::vector<double>& left_null_vector() const { return small_w_; }
  /// z with S z + zeta b = column, c' z = 0; both have size() + 1 entries, the last one of `column` zero, of z zeta.
  void solve_beside(const double* column, double* z) { lu_.solve(column, z); }

 private:
  void find_sizes(const CondensedSystem& condensed, const Orbit& x);
  bool solve_bordered();
  void begin_border();
  void follow_null_vectors();

  int multiplier_;
  CondensedReturnMap map_;
  SparseLu lu_;  // of the bordered S
  std::vector<double> values_;
  std::vector<double> column_;  // b
  std::vector<double> row_;     // c
  std::vector<double> row_sizes_, column_sizes_;
  std::vector<double> small_v_;  // v and G
  std::vector<double> small_w_;  // w and G
  std::vector<double> rhs_;
  bool started_ = false;
  double value_ = 0.0;
  double multiplicity_ = 0.0;
  OrbitVector v_;
  OrbitVector gradient_;
};

// Defining condition of torus curves: two multipliers of product one, G = det L - 1, and, where their angle theta is
// kept, H = tr L / 2 - cos theta = 0 too.
//
// The pair is followed as an invariant plane of the condensed return map S(mu) = S + mu E: the columns of V span it,
//
//     S V + E V L = 0,      V_last^T V = Id,
//
// by Newton's method on V and the 2 x 2 matrix L, whose eigenvalues are the pair, from the last plane. With the
// solution (W, K) of the transposed Newton system for the right-hand side (0, d det / d L), or (0, d tr / 2 d L) for
// H,
//
//     dG = -sum of w_k^T (dS) v_k:
//
// two directions in the sweep of second derivatives where one critical multiplier needs one. Regular as long as the
// pair differs from the other multipliers, also where its two halves meet: there, at the 1:1 and 1:2 resonance, a
// torus curve ends, and pairs of real multipliers of product one (neutral saddles) follow, of which only the nearest
// are admitted.

class CriticalPair final : public OrbitCondition {
 public:
  /// `multiplier`: where to begin, not a real number. `cosine`: of the angle that is kept, nothing where it is free.
  CriticalPair(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> multiplier,
               std::optional<double> cosine = std::nullopt);

  int count() const override { return kept_cosine_ ? 2 : 1; }

  /// False where no plane is found near the last one.
  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int k = 0) const override { return k == 0 ? pair_.determinant() - 1.0 : cosine() - *kept_cosine_; }
  const OrbitVector& gradient(int k = 0) const override { return gradients_[static_cast<std::size_t>(k)]; }
  /// False where the pair is real.
  bool put_critical_vectors(CriticalVectors& vectors) const override;
  /// Where the pair is real.
  std::string beyond_end() const override;
  /// L and V.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  /// Half the sum of the pair: the cosine of its angle on the curve, beyond +-1 where it is real.
  double cosine() const { return 0.5 * pair_.trace(); }
  /// The sine of the angle but for a positive factor, with the sense in which the plane is turned; the orientation of
  /// the plane is kept along the curve. A complex pair gives it one sign, which changes only where L is the unit matrix
  /// or its opposite: there the angle passes 0 or pi.
  double turning() const { return 0.5 * (pair_(1, 0) - pair_(0, 1)); }
  /// In the closed upper half plane; for a real pair the one nearer to zero.
  std::complex<double> multiplier() const;

 private:
  using Plane = Eigen::Matrix<double, Eigen::Dynamic, 2>;

  bool begin();
  bool find_plane();
  bool factorize();
  void set_right_hand_side();
  bool orthonormalise();
  bool find_gradient(CondensedSystem& condensed, const Orbit& x, const Eigen::Vector4d& by_pair, OrbitVector& gradient);

  CondensedReturnMap map_;
  std::complex<double> first_multiplier_;
  std::optional<double> kept_cosine_;
  SparseLu lu_;                 // of Newton's matrix for (V, L)
  std::vector<double> values_;  // of S
  std::vector<double> matrix_;
  Eigen::VectorXd rhs_;
  Eigen::VectorXd change_;
  Eigen::Matrix2d pair_;  // L
  Plane plane_;           // V
  Plane border_;          // V_last
  // of the last evaluation
  Eigen::Matrix2d left_pair_;  // L as it was with
  Plane left_plane_;           // W, S^T W + E^T W L^T = 0
  bool started_ = false;
  std::vector<OrbitVector> extended_;  // the columns of V
  std::vector<OrbitVector> gradients_;
};

// Defining condition of curves of branch points of periodic orbits: pitchforks (symmetry breaking) and transcritical
// points. Two numbers.
//
// With u the orbit and its durations, F(u, p) = 0 the boundary value problem and psi its left null vector, a branch
// in p_1 has a branch point where
//
//     F = 0,    F_u singular (psi^T F_u = 0),    psi^T F_{p_1} = 0.
//
// Count. N unknowns u and N equations F: N + 2 equations. Generic branch points are points in two parameters and
// curves in three,
//
//     unknowns  N + 3:  u, p_1, p_2, p_3        equations  N + 2, and pseudo-arclength.
//
// Where branch points persist in two parameters, psi^T F_{p_1} = psi^T F_{p_2} = 0 along the curve: F loses a rank,
// and a parameter b that unfolds it (orbit/ring_system.hpp) restores it,
//
//     F(u, p) + b phi = 0,    unknowns  N + 3:  u, p_1, p_2, b,
//
// with b = 0 as the result. Then the last condition is the same for every direction c of (p_1, p_2),
// H = psi^T (c_1 F_{p_1} + c_2 F_{p_2}) = 0, and the direction is taken in which G below changes most: the condition
// with p_1 alone is singular where the curve turns in p_2.
//
// G is that of the multiplier 1 (CriticalMultiplier), whose w is psi at the ends of segments: S(1) is F_u,
// condensed. The border of G being b, c, and S z + zeta b = F_c, c' z = 0 for F_c = sum of c_k F_{p_k},
//
//     H = w^T F_c,     dH = w^T (dF_c) - w^T (dS) z = -w^T d(S, F_p) (z, -c),
//
// one more sweep of second derivatives, in the direction (z, -c).

class CriticalBranchPoint final : public RealMultiplierCondition {
 public:
  /// Of a defining system of three problem parameters, or, unfolded, of two and b.
  CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape);
  /// The system outlives the condition, which gives it its phi.
  CriticalBranchPoint(const UnfoldedSystem& system, const OrbitShape& shape);

  int count() const override { return 2; }
  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int k) const override { return k == 0 ? multiplier_.value() : value_; }
  const OrbitVector& gradient(int k) const override { return k == 0 ? multiplier_.gradient() : gradient_; }
  /// The border of G, c and phi.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  std::optional<int> kept_multiplier() const override { return 1; }
  /// Where b is no longer zero.
  std::string beyond_end() const override;
  double multiplicity_function() const override { return multiplier_.multiplicity_function(); }

 private:
  CriticalBranchPoint(const DefiningSystem& system, const OrbitShape& shape, const UnfoldedSystem* unfolded);
  int directions() const { return unfolded_ != nullptr ? 2 : 1; }
  Eigen::Map<const Eigen::VectorXd> left_null() const {
    return Eigen::Map<const Eigen::VectorXd>(multiplier_.left_null_vector().data(), map_.size());
  }
  void begin();
  void choose_next(CondensedSystem& condensed);

  const UnfoldedSystem* unfolded_;  // null: generic branch points
  CondensedReturnMap map_;
  CriticalMultiplier multiplier_;
  Eigen::MatrixXd columns_;         // F_{p_k}, and a zero below each
  Eigen::MatrixXd solutions_;       // z, zeta of each
  Eigen::VectorXd direction_;       // c
  Eigen::VectorXd next_direction_;  // that of steps from here
  std::vector<double> next_phi_;    // likewise
  std::vector<double> inner_memory_;
  double value_ = 0.0;
  double b_ = 0.0;
  double size_ = 1.0;  // 1 + max |u|
  OrbitVector extended_;
  OrbitVector gradient_;
};

/// How much each free problem parameter breaks a branch point: |psi^T F_{p_k}| as a share of |psi| |F_{p_k}|, zero for
/// the parameter in which it is one. A column that is rounding against F_u counts as zero.
struct BranchPointBreaking {
  bool known = false;  ///< false where no null vector was found
  std::vector<double> shares;

  /// Does parameter k (from 0) break it? The asymmetry of a mesh leaves far less.
  bool by(std::size_t k) const { return shares[k] > 1e-3; }
};
BranchPointBreaking branch_point_breaking(const DefiningSystem& system, const Orbit& x);

// Defining condition of curves of two events at once: an event function vanishes at one end of a segment,
//
//     G(x) = h_e(x_s(0), p)     or     G(x) = h_e(x_s(1), p),
//
// besides what ends the segments there. One condition more than a periodic orbit has, so that a second parameter is
// free: n m + m + 2 unknowns besides the collocated functions, n m + m + 1 conditions and pseudo-arclength.

class DefiningSystem;

class EventCondition final : public OrbitCondition {
 public:
  /// `segment` counts from 0. h_e must not vanish there for every orbit of the signature.
  EventCondition(const DefiningSystem& system, const OrbitShape& shape, int segment, int event, bool at_end);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// Nothing is found by iteration.
  void remember(std::vector<double>& memory) const override { memory.clear(); }
  void recall(const std::vector<double>&) override {}

 private:
  const DefiningSystem& system_;
  int segment_;
  int event_;
  bool at_end_;
  int column_ = 0;  // of the gradient that is not zero
  double value_ = 0.0;
  OrbitVector gradient_;
};

}  // namespace tchat

/// Defining condition of curves of branch points of periodic orbits: pitchforks (symmetry breaking) and transcritical
/// points. Two numbers.
///
/// With u the orbit and its durations, F(u, p) = 0 the boundary value problem and psi its left null vector, a branch
/// in p_1 has a branch point where
///
///     F = 0,    F_u singular (psi^T F_u = 0),    psi^T F_{p_1} = 0.
///
/// Count. N unknowns u and N equations F: N + 2 equations. Generic branch points are points in two parameters and
/// curves in three,
///
///     unknowns  N + 3:  u, p_1, p_2, p_3        equations  N + 2, and pseudo-arclength.
///
/// Where branch points persist in two parameters, psi^T F_{p_1} = psi^T F_{p_2} = 0 along the curve: F loses a rank,
/// and a parameter b that unfolds it (orbit/unfolded_system.hpp) restores it,
///
///     F(u, p) + b phi = 0,    unknowns  N + 3:  u, p_1, p_2, b,
///
/// with b = 0 as the result. Then the last condition is the same for every direction c of (p_1, p_2),
/// H = psi^T (c_1 F_{p_1} + c_2 F_{p_2}) = 0, and the direction is taken in which G below changes most: the condition
/// with p_1 alone is singular where the curve turns in p_2.
///
/// G is that of the multiplier 1 (orbit/critical_multiplier.hpp), whose w is psi at the ends of segments: S(1) is F_u,
/// condensed. The border of G being b, c, and S z + zeta b = F_c, c' z = 0 for F_c = sum of c_k F_{p_k},
///
///     H = w^T F_c,     dH = w^T (dF_c) - w^T (dS) z = -w^T d(S, F_p) (z, -c),
///
/// one more sweep of second derivatives, in the direction (z, -c).
#pragma once

#include "orbit/critical_multiplier.hpp"
#include "orbit/unfolded_system.hpp"

namespace tchat {

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

}  // namespace tchat

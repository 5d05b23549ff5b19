/// Defining condition of torus curves: two multipliers of product one, G = det L - 1, and, where their angle theta is
/// kept, H = tr L / 2 - cos theta = 0 too.
///
/// The pair is followed as an invariant plane of the condensed return map S(mu) = S + mu E: the columns of V span it,
///
///     S V + E V L = 0,      V_last^T V = Id,
///
/// by Newton's method on V and the 2 x 2 matrix L, whose eigenvalues are the pair, from the last plane. With the
/// solution (W, K) of the transposed Newton system for the right-hand side (0, d det / d L), or (0, d tr / 2 d L) for
/// H,
///
///     dG = -sum of w_k^T (dS) v_k:
///
/// two directions in the sweep of second derivatives where one critical multiplier needs one. Regular as long as the
/// pair differs from the other multipliers, also where its two halves meet: there, at the 1:1 and 1:2 resonance, a
/// torus curve ends, and pairs of real multipliers of product one (neutral saddles) follow, of which only the nearest
/// are admitted.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "linear/sparse_lu.hpp"
#include "orbit/condensed_return_map.hpp"
#include "orbit/orbit_condition.hpp"

namespace tchat {

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

}  // namespace tchat

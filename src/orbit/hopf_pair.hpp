/// Defining condition of curves of Hopf bifurcations: a pair of eigenvalues of f_x of sum zero, G = trace L.
///
/// The pair is followed as an invariant plane of f_x: the columns of V span it,
///
///     f_x V - V L = 0,      V_last^T V = Id,                                  2 n + 4 equations for V and L (2 x 2)
///
/// by Newton's method from the last plane. With the solution (W, K) of the transposed Newton system for the right-hand
/// side (0, Id)
///
///     dG = -sum over k of w_k^T (d f_x) v_k.
///
/// Regular as long as the pair differs from the other eigenvalues, also where its two halves meet: there, at a
/// Bogdanov-Takens point (det L = 0), a curve of Hopf bifurcations ends, and neutral saddles follow.
///
/// Count: n functions, one duration and two parameters for 1 + n rows, G and pseudo-arclength.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "orbit/orbit_condition.hpp"

namespace tchat {

class DefiningSystem;

class HopfPair final : public OrbitCondition {
 public:
  /// It begins with the pair nearest to +-i omega, or, without an omega, to the imaginary axis.
  HopfPair(const DefiningSystem& system, const OrbitShape& shape, std::optional<double> omega = std::nullopt);

  /// False where no plane is found near the last one.
  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return pair_.trace(); }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// Where the pair is real.
  std::string beyond_end() const override;
  /// L and V.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  /// omega^2 on the curve, negative where the pair is real.
  double square() const { return pair_(0, 0) * pair_(1, 1) - pair_(0, 1) * pair_(1, 0); }

  /// The same as a share of |f_x|^2.
  double relative_square() const { return square() / jacobian_.squaredNorm(); }

  /// omega but for a positive factor, as a share of |f_x|, with the sense in which the plane is turned; the orientation
  /// of the plane is kept along the curve. A complex pair gives it one sign, which changes only where L = 0.
  double turning() const { return 0.5 * (pair_(1, 0) - pair_(0, 1)) / jacobian_.norm(); }

 private:
  using Plane = Eigen::Matrix<double, Eigen::Dynamic, 2>;

  bool begin();
  bool begin_at_double_zero();
  bool find_plane();
  Eigen::MatrixXd newton_matrix(const Plane& border) const;
  void orthonormalise();
  void add_gradient(const Orbit& x, const Eigen::VectorXd& v, const Eigen::VectorXd& w);

  const DefiningSystem& system_;
  std::optional<double> first_omega_;
  Eigen::MatrixXd jacobian_, by_state_, by_parameter_;
  Eigen::VectorXd field_;
  std::vector<double> direction_;  // v and no change of the parameters
  Eigen::Matrix2d pair_;           // L
  Plane plane_;                    // V
  bool started_ = false;
  OrbitVector gradient_;
};

}  // namespace tchat

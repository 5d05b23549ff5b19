/// Equilibria: their equations, the conditions of their folds and Hopf bifurcations, and the equilibrium near a state.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/defining_system.hpp"

namespace tchat {

// Problem type 1: equilibria, f_i(x, p) = 0.
//
// Such an equilibrium is an orbit of one segment of no duration: with T = 0 the collocated field (5.29) says that the
// state is the same at both nodes of the one interval (OrbitShape::point), and the rows that couple its ends are
//
//     T = 0,     f_i(x(1), p) = 0                                                        1 + n rows
//
// Count. Unknowns: n functions, one duration, q free parameters. Conditions: 1 + n rows and the border's: with
// pseudo-arclength q = 1, on curves of folds or Hopf points, which have one condition more, q = 2.

class EquilibriumSystem final : public DefiningSystem {
 public:
  /// `signature` has one segment, of which the field counts.
  EquilibriumSystem(const HybridSystem& system, Signature signature, std::vector<int> free_parameters);

  std::unique_ptr<BranchAnalysis> make_analysis(const OrbitShape& shape) const override;
  int field() const { return signature().front().field; }

  int coupling_rows(int) const override { return 1 + dimension(); }
  void coupling_pattern(int s, CouplingPattern& pattern) const override;
  void coupling_values(int s, const Orbit& x, double* values) const override;
  double* coupling_derivatives(int s, const Orbit& x, double* values, double* entries) const override;
  std::string coupling_name(int s, int r) const override;
  double coupling_unit(int, int r) const override { return r == 0 ? 1.0 : system().unit_of(r); }
  std::string coupling_failure(int s, const Orbit& x) const override;

  /// The sign of det [f_x f_p; t^T] for one free parameter, t the tangent at x, times the least singular value of this
  /// matrix scaled: zero at branch points, of constant sign through folds. At a branch point all of a row may vanish,
  /// so that none is scaled to unit size: a row r is divided by |r| + (1 + |x| + |p|) |dr/ds|, s the arclength.
  /// Allocates.
  std::optional<double> singular_distance(const Orbit& x, const OrbitVector& tangent) const override;
  /// The null vectors of that matrix. Newton's own, in which a row may be zero, need not have factors at a branch
  /// point. Allocates.
  std::vector<OrbitVector> crossing_directions(const Orbit& x, const OrbitVector& tangent) const override;

 private:
  mutable std::vector<double> by_state_, by_parameter_;  // n x n, n x q: scratch, as Newton's loop is not to allocate
};

// Defining condition of curves of folds of equilibria: f_x is singular.
//
// G(x, p) is the bordered solution
//
//     [ f_x  b ] [v]   [0]        [ f_x^T  c ] [w]   [0]
//     [ c'   0 ] [G] = [1],       [ b'     0 ] [G] = [1],        G = 0 exactly when f_x is singular,
//
// and its gradient is -w^T (d f_x) v. Regular at cusps and Bogdanov-Takens points.
//
// Count: n functions, one duration and two parameters for 1 + n rows, G and pseudo-arclength.

class DefiningSystem;

class EquilibriumFold final : public OrbitCondition {
 public:
  EquilibriumFold(const DefiningSystem& system, const OrbitShape& shape);

  bool evaluate(CondensedSystem& condensed, const Orbit& x) override;
  double value(int = 0) const override { return value_; }
  const OrbitVector& gradient(int = 0) const override { return gradient_; }
  /// The border b, c; empty before the first evaluation.
  void remember(std::vector<double>& memory) const override;
  void recall(const std::vector<double>& memory) override;

  /// w^T f_xx v v of null vectors of unit length: zero at a cusp.
  double cusp_function() const { return cusp_; }
  /// w^T v of null vectors of unit length: zero where the eigenvalue 0 is a double one (Bogdanov-Takens).
  double multiplicity_function() const { return column_.dot(row_); }

 private:
  bool solve_bordered();
  void begin_border();

  const DefiningSystem& system_;
  std::vector<double> direction_;  // v and no change of the parameters
  Eigen::VectorXd field_;
  Eigen::MatrixXd jacobian_, by_state_, by_parameter_;
  Eigen::VectorXd column_;  // b, follows w
  Eigen::VectorXd row_;     // c, follows v
  Eigen::VectorXd v_, w_;
  bool started_ = false;
  double value_ = 0.0;
  double cusp_ = 0.0;
  OrbitVector gradient_;
};

// Defining condition of curves of Hopf bifurcations: a pair of eigenvalues of f_x of sum zero, G = trace L.
//
// The pair is followed as an invariant plane of f_x: the columns of V span it,
//
//     f_x V - V L = 0,      V_last^T V = Id,                                  2 n + 4 equations for V and L (2 x 2)
//
// by Newton's method from the last plane. With the solution (W, K) of the transposed Newton system for the right-hand
// side (0, Id)
//
//     dG = -sum over k of w_k^T (d f_x) v_k.
//
// Regular as long as the pair differs from the other eigenvalues, also where its two halves meet: there, at a
// Bogdanov-Takens point (det L = 0), a curve of Hopf bifurcations ends, and neutral saddles follow.
//
// Count: n functions, one duration and two parameters for 1 + n rows, G and pseudo-arclength.

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

// The equilibrium that a state is near, by Newton's method.

struct NearbyEquilibrium {
  Eigen::VectorXd state;     ///< n: f_i(x, p) = 0 to rounding
  Eigen::MatrixXd jacobian;  ///< f_x there, without the rows and columns of ignored states
};

/// Of field `field` (from 1); nothing where Newton's method does not converge. Where f_x is singular the step is the
/// shortest one. States that nothing depends on (`ignored`, from 0) keep their values, and may move. `sizes`: of the
/// states, n.
std::optional<NearbyEquilibrium> find_equilibrium(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                                  const double* par, const std::vector<Eigen::Index>& ignored,
                                                  const Eigen::VectorXd& sizes);

/// A fold of equilibria in parameter `active` (a PAR index): where f = 0 and f_x is singular.
struct NearbyFold {
  Eigen::VectorXd state;     ///< n
  double parameter = 0.0;    ///< the value of the active one
  Eigen::MatrixXd jacobian;  ///< f_x there
};

/// By Newton's method for n + 1 unknowns x and p: f = 0 (n) and the least singular value w^T f_x v = 0 (1), whose
/// derivatives are w^T (d f_x) v, states and f in units of `sizes` (n) and of the terms of f_x there. Nothing where
/// that does not converge, or where w^T f_p = 0 or w^T f_xx v v has been lost on the way.
std::optional<NearbyFold> find_fold(const HybridSystem& system, int field, const Eigen::VectorXd& near,
                                    const Eigen::VectorXd& start, int active, const Eigen::VectorXd& sizes);

}  // namespace tchat

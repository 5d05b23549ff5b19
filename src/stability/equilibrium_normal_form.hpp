/// Normal forms of equilibria: folds, branch points and Hopf bifurcations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "orbit/defining_system.hpp"
#include "stability/normal_form.hpp"
#include "stability/return_map_forms.hpp"

namespace tchat {

// The derivatives of a field at an equilibrium, of the states that its mode has.

class EquilibriumForms {
 public:
  /// Both outlive this object.
  EquilibriumForms(const DefiningSystem& system, const Orbit& x);

  int states() const { return states_; }
  const HybridSystem& system() const { return system_.system(); }
  Eigen::VectorXd field() const { return field_; }
  Eigen::MatrixXd jacobian() const { return by_state_; }  ///< f_x
  /// f_p of the first free parameter.
  Eigen::VectorXd by_parameter() const { return by_parameter_; }

  /// f_xx u v and f_xxx u v w.
  Eigen::VectorXd second(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const { return part({&u, &v, nullptr}); }
  Eigen::VectorXd third(const Eigen::VectorXd& u, const Eigen::VectorXd& v, const Eigen::VectorXd& w) const {
    return part({&u, &v, &w});
  }
  /// The second derivative in two directions by the states and the first free parameter, which is their last entry.
  Eigen::VectorXd second_with_parameter(const Eigen::VectorXd& u, const Eigen::VectorXd& v) const;

 private:
  Eigen::VectorXd part(const std::array<const Eigen::VectorXd*, 3>& directions) const;
  int field_index() const { return system_.signature().front().field; }

  const DefiningSystem& system_;
  const Orbit& x_;
  int states_;
  Eigen::VectorXd field_, by_parameter_;
  Eigen::MatrixXd by_state_;
};

// Normal forms of equilibria with an eigenvalue 0: folds and branch points (Kuznetsov, Elements of Applied Bifurcation
// Theory, 3rd ed., 5.4; normal_form.hpp). With A = f_x, A q = lambda q, p A = lambda p for the eigenvalue lambda
// nearest to 0, p q = 1, |q| = 1 and the entry of q of largest modulus positive,
//
//     fold     a = p f_xx(q, q) / 2,     y' = p f_p s + a y^2
//     branch point: F = f, V = q, W = -p, b = -q, r = q', so that g is the rate of y.

/// a at a fold. Nothing where the eigenvalue nearest to 0 is complex or not simple. The place on the branch (EPSS) is
/// not in its uncertainty. Allocates.
std::optional<Coefficient> equilibrium_fold_form(const DefiningSystem& system, const Orbit& x);

/// Nothing where no branch crosses. Allocates.
std::optional<BranchingForm> equilibrium_branching(const DefiningSystem& system, const Orbit& x);

// The first Lyapunov coefficient of a Hopf bifurcation: which way the periodic orbits go that are born there.

/// l_1 at an equilibrium with the eigenvalues +- i omega, by the multilinear forms B and C of f (Kuznetsov, Elements of
/// Applied Bifurcation Theory, 5.4),
///
///     2 omega l_1 = Re ( p' C(q, q, q*) - 2 p' B(q, A^-1 B(q, q*)) + p' B(q*, (2 i omega - A)^-1 B(q, q)) ),
///
/// with A q = i omega q, A' p = -i omega p, |q| = 1, p' q = 1. B and C are as exact as the problem gives them: where C
/// is a difference of second derivatives it is good to about 1e-8. Negative: the orbits are stable on the side where
/// the equilibrium is not (supercritical). Not a number where it cannot be found. Allocates.
Coefficient first_lyapunov_coefficient(const DefiningSystem& system, const Orbit& x, double omega);

}  // namespace tchat

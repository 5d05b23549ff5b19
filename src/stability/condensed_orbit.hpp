/// Orbits as normal forms use them: derivatives of their equations, condensation on another mesh, and linear problems
/// for any multiplier.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit_expansion.hpp"
#include "orbit/return_map.hpp"
#include "stability/return_map_forms.hpp"

namespace tchat {

// What coefficients of resonances of an orbit are made of, derivatives of its equations; and for all coefficients the
// same orbit on a coarser mesh, which shows how well they are known.

/// Second and third derivatives of an orbit's equations, as rows of NodalSystem.
class OrbitForms {
 public:
  using Vector = Eigen::VectorXd;
  using ComplexVector = Eigen::VectorXcd;
  OrbitForms(const DefiningSystem& system, const Orbit& x) : expansion_(system), x_(x) {}

  Vector second(const Vector& u, const Vector& v) const;
  ComplexVector second(const ComplexVector& u, const ComplexVector& v) const;
  Vector third(const Vector& u, const Vector& v, const Vector& w) const;
  ComplexVector third(const ComplexVector& q) const;  ///< of q, q, q*
  ComplexVector cube(const ComplexVector& q) const;   ///< of q, q, q

 private:
  NodalExpansion expansion_;
  const Orbit& x_;
};

/// True for the multiplier 1.
bool is_fold(std::complex<double> critical);
/// Where M(mu) is factored for a critical multiplier.
double shift_for(std::complex<double> critical);

/// Interpolated.
Orbit on_every_second_point(const Orbit& x);

// An orbit condensed anew for the coefficients of its normal forms, and corrected on a coarser mesh.

class CondensedOrbit {
 public:
  /// For orbits of this shape, which have segments with one mesh in common, that nearly have the multiplier
  /// `critical`: exactly 1, exactly -1, or e^(i theta).
  CondensedOrbit(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> critical);

  /// At x, which stays as it is until the last call of forms(). False where the equations are singular or not finite.
  bool linearise(const Orbit& x);
  ReturnMapForms& forms() { return forms_; }
  /// Of all rows at x, which is linearised, until the next call.
  const RowWeights& residual(const Orbit& x);

  /// Newton's method at the same parameters, or near a fold at a start that moves across q alone, until it no longer
  /// comes nearer: rounding, which the orbit may amplify. False where it fails.
  bool correct(const Eigen::VectorXd& q, Orbit& x);

 private:
  const DefiningSystem& system_;
  std::complex<double> critical_;
  CondensedSystem condensed_;
  ReturnMapForms forms_;
  OrbitResidual residual_;
  RowWeights rows_;
};

/// Solutions of M(mu) v = r for any mu (return_map.hpp): M(mu) = M(mu_0) + (mu - mu_0) E F', where F picks v_1(0) and
/// E the n rows that close the orbit. K = F' M(mu_0)^-1 E has the eigenvalues 1 / (mu_0 - mu) of the multipliers mu.
class ShiftedOrbit {
 public:
  using Complex = std::complex<double>;
  using Vector = Eigen::VectorXd;
  using ComplexVector = Eigen::VectorXcd;

  /// `nodal` is of the orbit's shape, and used up.
  ShiftedOrbit(NodalSystem& nodal, const Orbit& x, double shift);

  bool is_regular() const { return regular_; }
  Eigen::Index size() const { return nodal_.size(); }
  Eigen::Index dimension() const { return n_; }
  /// E q.
  ComplexVector closing_rows(const ComplexVector& q) const;
  Vector closing_rows(const Vector& q) const;

  ComplexVector solve(Complex mu, const ComplexVector& right);

  /// M(mu) v + factor column = right with q' v_1(0) = 0: regular at mu = 1 where q is the critical direction and the
  /// column is not in the range of M(1).
  Vector solve_beside(double mu, const Vector& right, const Vector& column, const Vector& q, double& factor);

  /// The multiplier nearest to mu and its vectors V and W, with |V_1(0)| = 1 and W_closing V_1(0) = 1; false where
  /// there is none near mu. The entry of V_1(0) of largest modulus is positive.
  bool find_critical(Complex mu, ComplexVector& v, ComplexVector& w, Complex& multiplier);

  /// M(mu) v = right where mu is a simple multiplier with the vectors p and q and p has no part of the right-hand side;
  /// p v_1(0) = 0.
  ComplexVector solve_singular(Complex mu, const ComplexVector& right, const ComplexVector& p, const ComplexVector& q);

  /// Vectors of a double multiplier mu with one eigenvector: M V = 0, W M = 0, and M V1 = -E q, W1 M = -p F' with q =
  /// V_1(0), p = W_closing, |q| = 1, p q1 = p1 q = 1, p1 q1 = 0.
  struct DoubleVectors {
    Vector v, v1, w, w1;
  };
  /// Nothing where mu is not nearly a multiplier, or one with two eigenvectors.
  std::optional<DoubleVectors> find_double(double mu);

 private:
  ComplexVector solve_real(const ComplexVector& right);
  ComplexVector solve_real_adjoint(const ComplexVector& right);

  NodalSystem& nodal_;
  double shift_;
  Eigen::Index n_;
  bool regular_ = false;
  Eigen::MatrixXd closing_;  // M(mu_0)^-1 E
  Eigen::MatrixXd starts_;   // K
};

}  // namespace tchat

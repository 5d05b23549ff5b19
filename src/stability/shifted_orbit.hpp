/// Linear problems of an orbit for any multiplier, by one factorisation.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "bvp/nodal_system.hpp"

namespace tchat {

/// Solutions of M(mu) v = r for any mu (nodal_system.hpp): M(mu) = M(mu_0) + (mu - mu_0) E F', where F picks v_1(0) and
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
  /// E q.
  Vector closing_rows(const Vector& q) const;
  /// p's column of the first free parameter.
  Vector parameter_column() const { return nodal_.parameter_columns().col(0); }

  ComplexVector solve(Complex mu, const ComplexVector& right);

  /// M(mu) v + factor column = right with q' v_1(0) = 0: regular at mu = 1 where q is the critical direction and the
  /// column is not in the range of M(1).
  Vector solve_beside(double mu, const Vector& right, const Vector& column, const Vector& q, double& factor);

  /// The multiplier nearest to mu and its vectors V and W, with |V_1(0)| = 1 and W_closing V_1(0) = 1; false where
  /// there is none near mu. The entry of V_1(0) of largest modulus is positive.
  bool find_critical(Complex mu, ComplexVector& v, ComplexVector& w, Complex& multiplier);

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

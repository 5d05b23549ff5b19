/// What coefficients of resonances of an orbit are made of, derivatives of its equations; and for all coefficients the
/// same orbit on a coarser mesh, which shows how well they are known.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "orbit/orbit_expansion.hpp"
#include "stability/multilinear.hpp"

namespace tchat {

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

}  // namespace tchat

/// Sums over second and third derivatives of which coefficients of normal forms are made: of complex vectors from real
/// forms, and how well the sums are known.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "model/hybrid_system.hpp"

namespace tchat {

/// A real coefficient and how well it is known.
struct Coefficient {
  double value = 0.0;
  double uncertainty = 0.0;
};

/// B(u, v) of complex vectors; `form` is B of real ones.
template <class Form>
Eigen::VectorXcd bilinear(const Form& form, const Eigen::VectorXcd& u, const Eigen::VectorXcd& v) {
  const Eigen::VectorXd a = u.real(), b = u.imag(), c = v.real(), d = v.imag();
  Eigen::VectorXcd result(u.size());
  result.real() = form(a, c);
  result.imag().setZero();
  if (!d.isZero(0.0)) result.imag() += form(a, d);
  if (!b.isZero(0.0)) result.imag() += form(b, c);
  if (!b.isZero(0.0) && !d.isZero(0.0)) result.real() -= form(b, d);
  return result;
}

/// C(q, q, q*); `form` is C of real vectors. With q = a + i b it is (a a a + a b b) + i (a a b + b b b).
template <class Form>
Eigen::VectorXcd trilinear(const Form& form, const Eigen::VectorXcd& q) {
  const Eigen::VectorXd a = q.real(), b = q.imag();
  Eigen::VectorXcd result(q.size());
  result.real() = form(a, a, a);
  result.imag().setZero();
  if (b.isZero(0.0)) return result;
  result.real() += form(a, b, b);
  result.imag() = form(a, a, b) + form(b, b, b);
  return result;
}

/// A sum of products, and the sum of their sizes, which rounding is a share of.
struct Product {
  std::complex<double> value;
  double size = 0.0;
};

/// w^T rows, without conjugation.
Product product(const Eigen::VectorXcd& w, const Eigen::VectorXcd& rows);

/// The error of such sums as a share of their sizes: rounding, or that of differences. A problem without third
/// derivatives may leave second ones of jumps to differences, too.
double error_of_sums(const HybridSystem& system);

}  // namespace tchat

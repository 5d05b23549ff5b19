/// Multilinear forms of a return map, from which coefficients of normal forms of orbits are computed.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "linear/dense_matrix.hpp"
#include "linear/sparse_lu.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit_expansion.hpp"
#include "orbit/return_map.hpp"

namespace tchat {

// Sums over second and third derivatives of which coefficients of normal forms are made: of complex vectors from real
// forms, and how well the sums are known.

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

// Where an orbit's critical vectors start, from the starts of its solutions for other multipliers.

/// A q = mu q, p A = mu p of the return map's derivative A: |q| = 1, its entry of largest modulus positive, p q = 1.
struct CriticalStart {
  std::complex<double> multiplier;
  Eigen::VectorXcd right;  ///< q
  Eigen::VectorXcd left;   ///< p
};

/// Of the multiplier nearest to `wanted`, from K = (mu_0 - A)^-1, whose eigenvalues are 1 / (mu_0 - mu); nothing where
/// there is none near it.
std::optional<CriticalStart> critical_start(const Eigen::MatrixXd& k, double mu_0, std::complex<double> wanted);

// Coefficients of normal forms from an orbit whose segments are condensed.
//
// The equations of the whole orbit, M(mu) of return_map.hpp, are solved by way of S(mu), what is left of them at the
// ends of segments (return_map.hpp): of their elimination only the last connectivity depends on mu, and
// S(mu) = S(mu_0) + (mu - mu_0) E F', where F picks v_1(0) and E the last n rows. K = F' S(mu_0)^-1 E has the
// eigenvalues 1 / (mu_0 - mu) of the multipliers mu.
//
// With V and W the vectors of the multiplier, on all nodes and rows, V_1(0) = q = a + i b and u_k = cos(phi_k) a +
// sin(phi_k) b, phi_k = k pi / 3,
//
//     B(q, q*) = 2/3 sum B(u_k, u_k),                    B(q, q) = 4/3 sum e^(2 i phi_k) B(u_k, u_k)
//     C(q, q, q*) = 8/9 sum e^(i phi_k) C(u_k, u_k, u_k)                                  k = 0, 1, 2
//
// so that three passes over the orbit give all that is needed, for a real q one. What W makes of B(V, .) is found as
// the gradient of a curve's condition is, by weighted second derivatives.

class ReturnMapForms {
 public:
  using Complex = std::complex<double>;

  /// `pair`: of complex vectors, which need more room. Segments have one mesh in common.
  ReturnMapForms(const DefiningSystem& system, const OrbitShape& shape, bool pair);

  /// Factors S(mu_0) at x, where `condensed` holds the linearisation. Neither may change before the last call below,
  /// except for right-hand sides. False if S is singular or not finite.
  bool factorize(CondensedSystem& condensed, const Orbit& x, double mu_0);

  /// The vectors of the multiplier nearest to mu; false where there is none near it. Allocates.
  bool find_critical(Complex mu, CriticalVectors& found);

  /// To |V_1(0)| = 1, its largest entry positive, and W_closing V_1(0) = 1. False where that cannot be.
  bool normalise(CriticalVectors& vectors) const;

  /// a, c or d (normal_form.hpp) of the critical multiplier 1, -1 or e^(i theta) of normalised vectors, mu_0 = 1 but
  /// for a; size: of the terms of the sum.
  Product coefficient(const CriticalVectors& vectors, Complex critical);

  /// c, or the real part of d alone, where `factor` times `growth` is the derivative of the critical multiplier, or of
  /// its modulus: the curve's condition knows it.
  Product on_curve(const CriticalVectors& vectors, Complex critical, const OrbitVector& growth, double factor);

  RowWeights make_rows() const { return expansion_.make_rows(); }
  OrbitVector make_vector() const { return {shape_, system_.free_count()}; }
  /// The solution of M(mu_0) h = -rows.
  void solve(const RowWeights& rows, OrbitVector& h);
  /// M(1) h + factor column of free parameter k = -rows with q' h_1(0) = 0, h.globals(k) = factor. Allocates.
  void solve_across(const RowWeights& rows, const Eigen::VectorXd& q, Eigen::Index k, OrbitVector& h);
  /// The free parameter that moves the fold of these vectors the most. Allocates.
  Eigen::Index parameter_across(const CriticalVectors& vectors);

  /// V and W for the calls below, which allocate: normalised vectors of the multiplier 1, in forms that are not for a
  /// pair.
  void set_vectors(const CriticalVectors& vectors);
  const OrbitVector& right_vector() const { return vectors_.front(); }  ///< V
  /// M(1) h + zeta E q = -rows with q' h_1(0) = 0, q = V_1(0): returns zeta.
  double solve_beside(const RowWeights& rows, OrbitVector& h);
  /// The same for the rows' derivative by the first free parameter, with h.globals(0) = 1.
  double solve_along_parameter(OrbitVector& h);
  /// row = -W F''(v, .), F the equations; v.globals are read.
  void differentiate(const OrbitVector& v, OrbitVector& row) { differentiate(weights_.front(), v, row); }
  /// F''(V, V), until the next call, and W F'''(V, V, V).
  struct AlongVector {
    const RowWeights& second;
    Product third;
  };
  AlongVector find_along_vector();

 private:
  using Vector = Eigen::VectorXd;

  void put_closing();
  void find_rows();
  void find_products();
  void keep_planes(const RowWeights& weights, const OrbitVector& v, double factor, OrbitVector& row);
  void solve_ends(const RowWeights& rows, Vector& ends);
  double put_bordered(const Vector& column, const Vector& q, Vector& ends) const;
  void differentiate(const RowWeights& weights, const OrbitVector& v, OrbitVector& row);
  void combine_squares();
  void solve_twice(Complex mu);
  Product square();
  Product cube();
  Product cubes_of_pair(Complex critical);
  Product cube_of_pair(Complex critical);
  Product real_cube_of_pair(Complex critical);

  const DefiningSystem& system_;
  OrbitShape shape_;
  Eigen::Index n_;
  CondensedReturnMap map_;
  SparseLu lu_;  // of S(mu_0)
  DirectionalExpansion expansion_;
  CondensedSystem* condensed_ = nullptr;
  const Orbit* x_ = nullptr;
  double shift_ = 0.0;  // mu_0

  std::vector<double> values_;          // of S
  std::vector<double> condensed_rows_;  // m n
  Vector rhs_, ends_, other_ends_;      // as S
  Eigen::MatrixXd closing_;             // S(mu_0)^-1 E
  Eigen::MatrixXcd matrix_;             // n x n
  ComplexLu factors_;                   // of it
  Eigen::VectorXcd change_;             // n
  Vector f_;                            // n
  Eigen::MatrixXd fx_, fp_;

  // Real and imaginary parts, or the former alone:
  std::vector<OrbitVector> vectors_;  // V
  std::vector<RowWeights> weights_;   // W
  std::vector<OrbitVector> rows_;     // -w B(v, .), v and w parts of V and W: those of w one behind the other
  // Of the directions u_k:
  std::vector<RowWeights> second_, third_;
  std::vector<RowWeights> turned_;  // the parts of e^(-i theta) W
  // B(q, q*) and the parts of B(q, q), and their solutions (1 - A)^-1 and (mu^2 - A)^-1:
  std::vector<RowWeights> squares_;
  std::vector<OrbitVector> solutions_;
  OrbitVector scratch_, other_scratch_;
};

}  // namespace tchat

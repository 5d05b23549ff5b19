#include "stability/normal_form.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "bvp/mesh_adaptation.hpp"
#include "bvp/nodal_expansion.hpp"
#include "bvp/nodal_system.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;
using ComplexVector = Eigen::VectorXcd;

/// Solutions of M(mu) v = r for any mu, by one factorisation: M(mu) = M(mu_0) + (mu - mu_0) E F', where F picks v_1(0)
/// and E the n rows that close the orbit. K = F' M(mu_0)^-1 E has the eigenvalues 1 / (mu_0 - mu) of the multipliers
/// mu.
class ShiftedOrbit {
 public:
  /// `nodal` is of the orbit's shape, and used up.
  ShiftedOrbit(NodalSystem& nodal, const Orbit& x, double shift) : nodal_(nodal), shift_(shift), n_(x.shape.dimension) {
    regular_ = nodal_.factorize(x, shift);
    if (!regular_) return;
    closing_.resize(nodal_.size(), n_);
    for (Eigen::Index k = 0; k < n_; ++k) closing_.col(k) = nodal_.solve(Vector::Unit(size(), last_row() + k));
    starts_ = closing_.topRows(n_);
    regular_ = closing_.allFinite();
  }

  bool is_regular() const { return regular_; }
  Eigen::Index size() const { return nodal_.size(); }

  ComplexVector solve(Complex mu, const ComplexVector& right) {
    ComplexVector v = solve_real(right);
    const Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Identity(n_, n_) + (mu - shift_) * starts_;
    const ComplexVector start = matrix.partialPivLu().solve(v.head(n_));
    return v - (mu - shift_) * (closing_ * start);
  }

  /// M(mu) v + p's column dp = right for the first free parameter, with q' v_1(0) = 0: regular at a fold, mu = 1, where
  /// q is the critical direction.
  Vector solve_beside(double mu, const Vector& right, const Vector& q, double& dp) {
    const Vector v = nodal_.solve(right);
    const Vector by_parameter = nodal_.solve(nodal_.parameter_columns().col(0));
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n_ + 1, n_ + 1);
    matrix.topLeftCorner(n_, n_) = Eigen::MatrixXd::Identity(n_, n_) + (mu - shift_) * starts_;
    matrix.topRightCorner(n_, 1) = by_parameter.head(n_);
    matrix.bottomLeftCorner(1, n_) = q.transpose();
    Vector start(n_ + 1);
    start << v.head(n_), 0.0;
    start = matrix.partialPivLu().solve(start);
    dp = start(n_);
    return v - dp * by_parameter - (mu - shift_) * (closing_ * start.head(n_));
  }

  /// The vectors V and W of the multiplier nearest to mu, with |V_1(0)| = 1 and W_closing V_1(0) = 1; false where there
  /// is none near it.
  bool find_critical(Complex mu, ComplexVector& v, ComplexVector& w) {
    const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> right(starts_.cast<Complex>());
    const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> left(starts_.transpose().cast<Complex>());
    if (right.info() != Eigen::Success || left.info() != Eigen::Success) return false;
    const auto nearest = [&](const ComplexVector& values) {
      Eigen::Index at = 0;
      (values.array() - 1.0 / (shift_ - mu)).abs().minCoeff(&at);
      return at;
    };
    const Eigen::Index at = nearest(right.eigenvalues());
    const Complex multiplier = shift_ - 1.0 / right.eigenvalues()(at);
    if (!(std::abs(multiplier - mu) < 1e-2)) return false;
    ComplexVector q = right.eigenvectors().col(at);
    Eigen::Index largest = 0;
    q.cwiseAbs().maxCoeff(&largest);
    q *= std::abs(q(largest)) / q(largest) / q.norm();
    ComplexVector p = left.eigenvectors().col(nearest(left.eigenvalues()));
    p /= (p.transpose() * q)(0);
    if (!p.allFinite()) return false;
    v = (shift_ - multiplier) * (closing_ * q);
    ComplexVector start = ComplexVector::Zero(size());
    start.head(n_) = p;
    w = (shift_ - multiplier) * solve_real_adjoint(start);
    return true;
  }

 private:
  Eigen::Index last_row() const { return size() - n_; }
  template <class Solve>
  static ComplexVector by_parts(const ComplexVector& right, const Solve& solve) {
    ComplexVector result(right.size());
    result.real() = solve(Vector(right.real()));
    if (right.imag().isZero(0.0))
      result.imag().setZero();
    else
      result.imag() = solve(Vector(right.imag()));
    return result;
  }
  ComplexVector solve_real(const ComplexVector& right) {
    return by_parts(right, [&](const Vector& part) { return nodal_.solve(part); });
  }
  ComplexVector solve_real_adjoint(const ComplexVector& right) {
    return by_parts(right, [&](const Vector& part) { return nodal_.solve_adjoint(part); });
  }

  NodalSystem& nodal_;
  double shift_;
  Eigen::Index n_;
  bool regular_ = false;
  Eigen::MatrixXd closing_;  // M(mu_0)^-1 E
  Eigen::MatrixXd starts_;   // K
};

/// Second and third derivatives of the orbit's equations.
class Forms {
 public:
  Forms(const DefiningSystem& system, const Orbit& x) : expansion_(system), x_(x) {}

  Vector second(const Vector& u, const Vector& v) const {
    NodalParts parts{};
    parts[1] = &u, parts[2] = &v;
    return expansion_.part(x_, parts, 3);
  }
  ComplexVector second(const ComplexVector& u, const ComplexVector& v) const {
    const Vector a = u.real(), b = u.imag(), c = v.real(), d = v.imag();
    ComplexVector result(u.size());
    result.real() = second(a, c);
    result.imag().setZero();
    if (!d.isZero(0.0)) result.imag() += second(a, d);
    if (!b.isZero(0.0)) result.imag() += second(b, c);
    if (!b.isZero(0.0) && !d.isZero(0.0)) result.real() -= second(b, d);
    return result;
  }

  Vector third(const Vector& u, const Vector& v, const Vector& w) const {
    NodalParts parts{};
    parts[1] = &u, parts[2] = &v, parts[4] = &w;
    return expansion_.part(x_, parts, 7);
  }
  /// Of q, q, q*: with q = a + i b it is (a a a + a b b) + i (a a b + b b b).
  ComplexVector third(const ComplexVector& q) const {
    const Vector a = q.real(), b = q.imag();
    ComplexVector result(q.size());
    result.real() = third(a, a, a);
    result.imag().setZero();
    if (b.isZero(0.0)) return result;
    result.real() += third(a, b, b);
    result.imag() = third(a, a, b) + third(b, b, b);
    return result;
  }

 private:
  NodalExpansion expansion_;
  const Orbit& x_;
};

/// A sum of products, and the sum of their sizes, which rounding is a share of.
struct Product {
  Complex value;
  double size = 0.0;
};
Product product(const ComplexVector& w, const ComplexVector& rows) {
  return {(w.transpose() * rows)(0), w.cwiseAbs().dot(rows.cwiseAbs())};
}

constexpr double rounding_of_sums = 1e-13;  // of sums over all nodes, and of the vectors that solve sparse systems

/// As a share of the terms: rounding, or differences for derivatives that the problem does not give.
double error_of_sums(const HybridSystem& system) {
  if (system.has_third()) return rounding_of_sums;
  constexpr double of_second = 1e-6, of_third = 1e-7;
  return system.table().derivative_order < 2 ? of_second : of_third;
}

bool is_fold(Complex critical) { return critical == Complex(1.0, 0.0); }
double shift_for(Complex critical) { return is_fold(critical) ? -1.0 : 1.0; }

/// `direction` becomes q.
std::optional<NormalForm> form_of(const DefiningSystem& system, NodalSystem& nodal, const Orbit& x, Complex critical,
                                  ComplexVector& direction) {
  ShiftedOrbit orbit(nodal, x, shift_for(critical));
  ComplexVector v, w;
  if (!orbit.is_regular() || !orbit.find_critical(critical, v, w)) return std::nullopt;
  direction = v.head(x.shape.dimension);
  const Forms forms(system, x);
  const ComplexVector vv = forms.second(v, v);
  if (is_fold(critical)) {
    const Product sum = product(w, vv);
    if (!std::isfinite(sum.size)) return std::nullopt;
    return NormalForm{-0.5 * sum.value, 0.5 * rounding_of_sums * sum.size};
  }
  ComplexVector rows = forms.third(v);
  Complex factor = -1.0 / 6.0;
  if (critical == Complex(-1.0, 0.0)) {
    rows += 3.0 * forms.second(v, orbit.solve(1.0, -vv));
  } else {
    const ComplexVector conjugate = v.conjugate();
    rows += 2.0 * forms.second(v, orbit.solve(1.0, -forms.second(v, conjugate)));
    rows += forms.second(conjugate, orbit.solve(critical * critical, -vv));
    factor = -0.5 / critical;
  }
  const Product sum = product(w, rows);
  if (!std::isfinite(sum.size)) return std::nullopt;
  return NormalForm{factor * sum.value, error_of_sums(system.system()) * std::abs(factor) * sum.size};
}

Orbit on_every_second_point(const Orbit& x) {
  Orbit coarse = x;
  coarse.mesh.clear();
  for (int j = 0; j < x.shape.intervals; j += 2) coarse.mesh.push_back(x.mesh[static_cast<std::size_t>(j)]);
  coarse.mesh.push_back(1.0);
  coarse.shape.intervals = static_cast<int>(coarse.mesh.size()) - 1;
  coarse.states = interpolate_states(x.states, x.shape, x.mesh, coarse.shape, coarse.mesh);
  return coarse;
}

/// Chord iteration at the same parameters, or near a fold at a start that moves across q alone. False where it fails.
bool correct(const DefiningSystem& system, NodalSystem& nodal, Complex critical, const Vector& q, Orbit& x) {
  const NodalExpansion expansion(system);
  ShiftedOrbit orbit(nodal, x, shift_for(critical));
  if (!orbit.is_regular()) return false;
  constexpr int most_iterations = 10;
  for (int k = 0; k < most_iterations; ++k) {
    const Vector right = -expansion.part(x, {}, 0);
    double dp = 0.0;
    const Vector change = is_fold(critical) ? orbit.solve_beside(1.0, right, q, dp) : orbit.solve(1.0, right).real();
    if (!change.allFinite()) return false;
    x.states += Eigen::Map<const Eigen::MatrixXd>(change.data(), x.states.rows(), x.states.cols());
    for (int s = 0; s < x.shape.segments; ++s) x.duration(s) += change(change.size() - x.shape.segments + s);
    x.par(system.free_parameters().front() - 1) += dp;
    if (change.lpNorm<Eigen::Infinity>() < 1e-11 * (1.0 + x.states.cwiseAbs().maxCoeff())) return true;
  }
  return false;
}

}  // namespace

std::optional<NormalForm> normal_form(const DefiningSystem& system, const Orbit& x, Complex critical) {
  if (x.shape.own || x.shape.intervals < 2) return std::nullopt;
  ComplexVector q;
  NodalSystem fine(system, x.shape);
  std::optional<NormalForm> form = form_of(system, fine, x, critical, q);
  if (!form) return form;
  Orbit other = on_every_second_point(x);
  NodalSystem coarse(system, other.shape);
  if (!correct(system, coarse, critical, q.real(), other)) return std::nullopt;
  ComplexVector coarse_q;
  const std::optional<NormalForm> compared = form_of(system, coarse, other, critical, coarse_q);
  if (!compared) return std::nullopt;
  const bool is_turned = is_fold(critical) && q.real().dot(coarse_q.real()) < 0.0;  // two entries are largest
  form->uncertainty += std::abs(form->coefficient - (is_turned ? -1.0 : 1.0) * compared->coefficient);
  return form;
}

}  // namespace tchat

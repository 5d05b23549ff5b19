#include "stability/condensed_orbit.hpp"

#include <cmath>
#include <type_traits>
#include <utility>

#include "base/levels.hpp"
#include "linear/dense_matrix.hpp"
#include "model/scales.hpp"
#include "orbit/mesh_adaptation.hpp"

namespace tchat {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;
using ComplexVector = Eigen::VectorXcd;

Vector OrbitForms::second(const Vector& u, const Vector& v) const {
  NodalParts parts{};
  parts[1] = &u, parts[2] = &v;
  return expansion_.part(x_, parts, 3);
}

ComplexVector OrbitForms::second(const ComplexVector& u, const ComplexVector& v) const {
  return bilinear([this](const Vector& a, const Vector& b) { return second(a, b); }, u, v);
}

Vector OrbitForms::third(const Vector& u, const Vector& v, const Vector& w) const {
  NodalParts parts{};
  parts[1] = &u, parts[2] = &v, parts[4] = &w;
  return expansion_.part(x_, parts, 7);
}

ComplexVector OrbitForms::third(const ComplexVector& q) const {
  return trilinear([this](const Vector& a, const Vector& b, const Vector& c) { return third(a, b, c); }, q);
}

/// With q = a + i b it is (a a a - 3 a b b) + i (3 a a b - b b b).
ComplexVector OrbitForms::cube(const ComplexVector& q) const {
  const Vector a = q.real(), b = q.imag();
  ComplexVector result(q.size());
  result.real() = third(a, a, a) - 3.0 * third(a, b, b);
  result.imag() = 3.0 * third(a, a, b) - third(b, b, b);
  return result;
}

bool is_fold(Complex critical) { return critical == Complex(1.0, 0.0); }
double shift_for(Complex critical) { return is_fold(critical) ? -1.0 : 1.0; }

Orbit on_every_second_point(const Orbit& x) {
  Orbit coarse = x;
  coarse.mesh.clear();
  for (int j = 0; j < x.shape.intervals; j += 2) coarse.mesh.push_back(x.mesh[static_cast<std::size_t>(j)]);
  coarse.mesh.push_back(1.0);
  coarse.shape.intervals = static_cast<int>(coarse.mesh.size()) - 1;
  coarse.states = interpolate_states(x.states, x.shape, x.mesh, coarse.shape, coarse.mesh);
  return coarse;
}

namespace {

/// What the coupling rows of the system leave open.
int open_rows(const DefiningSystem& system) {
  int open = (system.dimension() + 1) * system.segments() + system.free_count();
  for (int s = 0; s < system.segments(); ++s) open -= system.coupling_rows(s);
  return open;
}

}  // namespace

CondensedOrbit::CondensedOrbit(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> critical)
    : system_(system),
      critical_(critical),
      condensed_(system, shape, {0, open_rows(system)}),
      forms_(system, shape, critical.imag() != 0.0),
      residual_(condensed_.make_residual()),
      rows_(forms_.make_rows()) {}

bool CondensedOrbit::linearise(const Orbit& x) {
  return condensed_.condense(x, {}, residual_) == Linearization::ready &&
         forms_.factorize(condensed_, x, shift_for(critical_));
}

/// Those of the collocation rows are known from the linearisation.
const RowWeights& CondensedOrbit::residual(const Orbit& x) {
  const int n = system_.dimension();
  rows_.collocation = residual_.collocation;
  Eigen::VectorXd jump(n);
  for (int s = 0; s < system_.segments(); ++s) {
    const IndexVector& index = system_.signature()[static_cast<std::size_t>(s)];
    auto ends = rows_.ends.begin() + static_cast<std::ptrdiff_t>(s) * (1 + n);
    *ends++ = system_.has_event(s) ? system_.system().event(index.event, x.end(s), x.par.data()) : 0.0;
    system_.system().value(FunctionKind::jump, index.jump, x.end(s), x.par.data(), jump.data());
    system_.clear_absent(s, jump.data(), 1);
    const double* const next = x.start((s + 1) % system_.segments());
    for (int a = 0; a < n; ++a) *ends++ = next[a] - jump(a);
  }
  return rows_;
}

bool CondensedOrbit::correct(const Eigen::VectorXd& q, Orbit& x) {
  constexpr int most_iterations = 10;
  double last = level::stalled;
  OrbitVector change = forms_.make_vector();
  change.set_zero();
  std::optional<Eigen::Index> parameter;
  for (int k = 0; k < most_iterations; ++k) {
    if (!linearise(x)) return false;
    const RowWeights& rows = residual(x);
    if (!is_fold(critical_)) {
      forms_.solve(rows, change);
    } else {
      CriticalVectors vectors;
      if (!parameter) parameter = forms_.find_critical(critical_, vectors) ? forms_.parameter_across(vectors) : 0;
      forms_.solve_across(rows, q, *parameter, change);
    }
    const double size = std::max(change.states.lpNorm<Eigen::Infinity>() / (1.0 + x.states.cwiseAbs().maxCoeff()),
                                 change.durations.lpNorm<Eigen::Infinity>() / std::abs(x.period()));
    if (!std::isfinite(size) || !change.globals.allFinite()) return false;
    advance(x, 1.0, change, system_.free_parameters());
    if (size < level::converged || (last < level::stalled && size > 0.5 * last)) return true;
    last = size;
  }
  return false;
}

namespace {

template <class Solve>
Eigen::VectorXcd by_parts(const Eigen::VectorXcd& right, const Solve& solve) {
  Eigen::VectorXcd result(right.size());
  result.real() = solve(Eigen::VectorXd(right.real()));
  if (right.imag().isZero(0.0))
    result.imag().setZero();
  else
    result.imag() = solve(Eigen::VectorXd(right.imag()));
  return result;
}

/// x and a number g with A x + g column = right, row x = 0.
template <class Number>
Eigen::Matrix<Number, Eigen::Dynamic, 1> solve_bordered(const Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>& a,
                                                        const Eigen::Matrix<Number, Eigen::Dynamic, 1>& column,
                                                        const Eigen::Matrix<Number, Eigen::Dynamic, 1>& row,
                                                        const Eigen::Matrix<Number, Eigen::Dynamic, 1>& right) {
  const Eigen::Index n = a.rows();
  Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> matrix(n + 1, n + 1);
  matrix << a, column, row.transpose(), Number(0.0);
  Eigen::Matrix<Number, Eigen::Dynamic, 1> rights(n + 1);
  rights << right, Number(0.0);
  if constexpr (std::is_same_v<Number, double>)
    return solve(matrix, rights).col(0).head(n);
  else
    return solve_complex(matrix, rights).head(n);
}

}  // namespace

ShiftedOrbit::ShiftedOrbit(NodalSystem& nodal, const Orbit& x, double shift)
    : nodal_(nodal), shift_(shift), n_(x.shape.dimension) {
  regular_ = nodal_.factorize(x, shift);
  if (!regular_) return;
  closing_.resize(nodal_.size(), n_);
  for (Eigen::Index k = 0; k < n_; ++k) closing_.col(k) = nodal_.solve(closing_rows(Vector(Vector::Unit(n_, k))));
  starts_ = closing_.topRows(n_);
  regular_ = closing_.allFinite();
}

ShiftedOrbit::Vector ShiftedOrbit::closing_rows(const Vector& q) const {
  Vector rows = Vector::Zero(size());
  rows.tail(n_) = q;
  return rows;
}

ShiftedOrbit::ComplexVector ShiftedOrbit::closing_rows(const ComplexVector& q) const {
  ComplexVector rows = ComplexVector::Zero(size());
  rows.tail(n_) = q;
  return rows;
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve(Complex mu, const ComplexVector& right) {
  ComplexVector v = solve_real(right);
  const Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Identity(n_, n_) + (mu - shift_) * starts_;
  const ComplexVector start = solve_complex(matrix, v.head(n_));
  return v - (mu - shift_) * (closing_ * start);
}

ShiftedOrbit::Vector ShiftedOrbit::solve_beside(double mu, const Vector& right, const Vector& column, const Vector& q,
                                                double& factor) {
  const Vector v = nodal_.solve(right);
  const Vector by_factor = nodal_.solve(column);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n_ + 1, n_ + 1);
  matrix.topLeftCorner(n_, n_) = Eigen::MatrixXd::Identity(n_, n_) + (mu - shift_) * starts_;
  matrix.topRightCorner(n_, 1) = by_factor.head(n_);
  matrix.bottomLeftCorner(1, n_) = q.transpose();
  Vector start(n_ + 1);
  start << v.head(n_), 0.0;
  start = tchat::solve(matrix, start);
  factor = start(n_);
  return v - factor * by_factor - (mu - shift_) * (closing_ * start.head(n_));
}

bool ShiftedOrbit::find_critical(Complex mu, ComplexVector& v, ComplexVector& w, Complex& multiplier) {
  std::optional<CriticalStart> found = critical_start(starts_, shift_, mu);
  if (!found) return false;
  const HybridSystem& system = nodal_.system().system();
  const Complex entry = found->right(largest_in_users_units(system, found->right));
  const Complex factor = std::abs(entry) / entry / length_in_users_units(system, found->right);
  found->right *= factor;
  found->left /= factor;
  multiplier = found->multiplier;
  v = (shift_ - multiplier) * (closing_ * found->right);
  ComplexVector start = ComplexVector::Zero(size());
  start.head(n_) = found->left;
  w = (shift_ - multiplier) * solve_real_adjoint(start);
  return true;
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve_singular(Complex mu, const ComplexVector& right, const ComplexVector& p,
                                                         const ComplexVector& q) {
  const ComplexVector v = solve_real(right);
  const Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Identity(n_, n_) + (mu - shift_) * starts_;
  const ComplexVector start = solve_bordered<Complex>(matrix, q, p, v.head(n_));
  return v - (mu - shift_) * (closing_ * start);
}

std::optional<ShiftedOrbit::DoubleVectors> ShiftedOrbit::find_double(double mu) {
  const double distance = mu - shift_;
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n_, n_) + distance * starts_;
  const SingularVectors vectors = singular_vectors(matrix);
  constexpr double singular = 1e-2;
  const Vector& sizes = vectors.sizes;
  if (n_ < 2 || !(sizes(n_ - 1) < singular * sizes(n_ - 2))) return std::nullopt;
  Vector q = vectors.right.col(n_ - 1);
  Vector p = vectors.left.col(n_ - 1);
  const HybridSystem& system = nodal_.system().system();
  q *= (q(largest_in_users_units(system, q)) < 0.0 ? -1.0 : 1.0) / length_in_users_units(system, q);
  const Vector q1 = solve_bordered<double>(matrix, p, q, -starts_ * q);
  p /= p.dot(q1);
  Vector p1 = solve_bordered<double>(matrix.transpose(), q, p, -starts_.transpose() * p);
  p1 -= p1.dot(q1) * p;
  const auto weights = [this](const Vector& start) {
    Vector right = Vector::Zero(size());
    right.head(n_) = start;
    return nodal_.solve_adjoint(right);
  };
  DoubleVectors found{-distance * (closing_ * q), -(closing_ * (q + distance * q1)), -distance * weights(p),
                      -weights(p + distance * p1)};
  const bool is_finite = found.v1.allFinite() && found.w.allFinite() && found.w1.allFinite();
  return is_finite ? std::optional(std::move(found)) : std::nullopt;
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve_real(const ComplexVector& right) {
  return by_parts(right, [&](const Vector& part) { return nodal_.solve(part); });
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve_real_adjoint(const ComplexVector& right) {
  return by_parts(right, [&](const Vector& part) { return nodal_.solve_adjoint(part); });
}

}  // namespace tchat

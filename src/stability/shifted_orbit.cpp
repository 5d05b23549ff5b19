#include "stability/shifted_orbit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace tchat {

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

}  // namespace

ShiftedOrbit::ShiftedOrbit(NodalSystem& nodal, const Orbit& x, double shift)
    : nodal_(nodal), shift_(shift), n_(x.shape.dimension) {
  regular_ = nodal_.factorize(x, shift);
  if (!regular_) return;
  closing_.resize(nodal_.size(), n_);
  for (Eigen::Index k = 0; k < n_; ++k) closing_.col(k) = nodal_.solve(closing_rows(Vector::Unit(n_, k)));
  starts_ = closing_.topRows(n_);
  regular_ = closing_.allFinite();
}

ShiftedOrbit::Vector ShiftedOrbit::closing_rows(const Vector& q) const {
  Vector rows = Vector::Zero(size());
  rows.tail(n_) = q;
  return rows;
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve(Complex mu, const ComplexVector& right) {
  ComplexVector v = solve_real(right);
  const Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Identity(n_, n_) + (mu - shift_) * starts_;
  const ComplexVector start = matrix.partialPivLu().solve(v.head(n_));
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
  start = matrix.partialPivLu().solve(start);
  factor = start(n_);
  return v - factor * by_factor - (mu - shift_) * (closing_ * start.head(n_));
}

bool ShiftedOrbit::find_critical(Complex mu, ComplexVector& v, ComplexVector& w, Complex& multiplier) {
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> right(starts_.cast<Complex>());
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> left(starts_.transpose().cast<Complex>());
  if (right.info() != Eigen::Success || left.info() != Eigen::Success) return false;
  const auto nearest = [&](const ComplexVector& values) {
    Eigen::Index at = 0;
    (values.array() - 1.0 / (shift_ - mu)).abs().minCoeff(&at);
    return at;
  };
  const Eigen::Index at = nearest(right.eigenvalues());
  multiplier = shift_ - 1.0 / right.eigenvalues()(at);
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

ShiftedOrbit::ComplexVector ShiftedOrbit::solve_real(const ComplexVector& right) {
  return by_parts(right, [&](const Vector& part) { return nodal_.solve(part); });
}

ShiftedOrbit::ComplexVector ShiftedOrbit::solve_real_adjoint(const ComplexVector& right) {
  return by_parts(right, [&](const Vector& part) { return nodal_.solve_adjoint(part); });
}

}  // namespace tchat

#include "stability/lyapunov_coefficient.hpp"

#include <cmath>
#include <complex>

#include "linear_algebra/dense_matrix.hpp"
#include "stability/equilibrium_eigenvalues.hpp"

namespace tchat {

namespace {

using Complex = std::complex<double>;
using RealVector = Eigen::VectorXd;
using ComplexVector = Eigen::VectorXcd;

/// The second and third derivatives of the field at an equilibrium.
class MultilinearForms {
 public:
  MultilinearForms(const DefiningSystem& system, const Orbit& x) : system_(system), x_(x) {}

  /// B(u, .) as a matrix at x + shift.
  Eigen::MatrixXd second(const RealVector& u, const RealVector& shift) const {
    const Eigen::Index n = u.size();
    const RealVector at = Eigen::Map<const RealVector>(x_.end(0), n) + shift;
    RealVector f(n);
    Eigen::MatrixXd matrix(n, n);
    system_.system().second(FunctionKind::field, system_.signature().front().field, at.data(), x_.par.data(), {},
                            u.data(), f.data(), matrix.data(), nullptr);
    return matrix;
  }

  ComplexVector second(const ComplexVector& u, const ComplexVector& v) const {
    const RealVector none = RealVector::Zero(u.size());
    const Eigen::MatrixXd by_real = second(RealVector(u.real()), none);
    const Eigen::MatrixXd by_imaginary = second(RealVector(u.imag()), none);
    ComplexVector result(u.size());
    result.real() = by_real * v.real() - by_imaginary * v.imag();
    result.imag() = by_real * v.imag() + by_imaginary * v.real();
    return result;
  }

  /// C(q, q, q*) = C(a, a, a) + C(a, b, b) + i (C(a, a, b) + C(b, b, b)) for q = a + i b.
  ComplexVector third(const ComplexVector& q) const {
    ComplexVector result(q.size());
    result.real() = third_along(q.real(), q);
    result.imag() = third_along(q.imag(), q);
    return result;
  }

 private:
  /// C(a, a, u) + C(b, b, u): a central difference, extrapolated.
  RealVector third_along(const RealVector& u, const ComplexVector& q) const {
    const double step = 1e-3 * (1.0 + Eigen::Map<const RealVector>(x_.end(0), u.size()).norm());
    const RealVector a = q.real();
    const RealVector b = q.imag();
    const auto sum = [&](double h) { return RealVector(second(a, h * u) * a + second(b, h * u) * b); };
    const auto difference = [&](double h) { return RealVector((sum(h) - sum(-h)) / (2.0 * h)); };
    return (4.0 * difference(0.5 * step) - difference(step)) / 3.0;
  }

  const DefiningSystem& system_;
  const Orbit& x_;
};

}  // namespace

double first_lyapunov_coefficient(const DefiningSystem& system, const Orbit& x, double omega) {
  const Eigen::MatrixXd a = equilibrium_jacobian(system, x);
  const MultilinearForms forms(system, x);
  const ComplexVector q = eigenvector(a, {0.0, omega});
  ComplexVector p = eigenvector(a.transpose(), {0.0, -omega});
  p /= std::conj(p.dot(q));  // dot conjugates its first vector
  const ComplexVector qbar = q.conjugate();
  const ComplexVector mean = solve_shifted(a, 0.0, forms.second(q, qbar));
  const ComplexVector twice = -solve_shifted(a, {0.0, 2.0 * omega}, forms.second(q, q));
  const Complex sum = p.dot(forms.third(q)) - 2.0 * p.dot(forms.second(q, mean)) + p.dot(forms.second(qbar, twice));
  return sum.real() / (2.0 * omega);
}

}  // namespace tchat

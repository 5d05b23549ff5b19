#include "stability/lyapunov_coefficient.hpp"

#include <complex>

#include "linear/dense_matrix.hpp"
#include "stability/equilibrium_forms.hpp"

namespace tchat {

Coefficient first_lyapunov_coefficient(const DefiningSystem& system, const Orbit& x, double omega) {
  using Vector = Eigen::VectorXd;
  using ComplexVector = Eigen::VectorXcd;
  const EquilibriumForms forms(system, x);
  const Eigen::MatrixXd a = forms.jacobian();
  const auto second = [&](const Vector& u, const Vector& v) { return forms.second(u, v); };
  const auto third = [&](const Vector& u, const Vector& v, const Vector& w) { return forms.third(u, v, w); };
  const ComplexVector q = eigenvector(a, {0.0, omega});
  ComplexVector p = eigenvector(a.transpose(), {0.0, -omega});
  p /= std::conj(p.dot(q));  // dot conjugates its first vector
  const ComplexVector w = p.conjugate(), qbar = q.conjugate();
  const ComplexVector mean = solve_shifted(a, 0.0, bilinear(second, q, qbar));
  const ComplexVector twice = -solve_shifted(a, {0.0, 2.0 * omega}, bilinear(second, q, q));
  const Product cubic = product(w, trilinear(third, q));
  const Product by_mean = product(w, bilinear(second, q, mean));
  const Product by_twice = product(w, bilinear(second, qbar, twice));
  const std::complex<double> sum = cubic.value - 2.0 * by_mean.value + by_twice.value;
  const double error = error_of_sums(system.system()) * (cubic.size + 2.0 * by_mean.size + by_twice.size);
  return {sum.real() / (2.0 * omega), error / (2.0 * omega)};
}

}  // namespace tchat

#include "stability/equilibrium_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "linear/dense_matrix.hpp"

namespace tchat {

Eigen::MatrixXd equilibrium_jacobian(const DefiningSystem& system, const Orbit& x) {
  const int n = system.dimension();
  Eigen::VectorXd f(n);
  Eigen::MatrixXd jacobian(n, n);
  system.system().first(FunctionKind::field, system.signature().front().field, x.end(0), x.par.data(), {}, f.data(),
                        jacobian.data(), nullptr);
  return jacobian;
}

FloquetMultipliers equilibrium_eigenvalues(const DefiningSystem& system, const Orbit& x) {
  FloquetMultipliers result;
  result.are_eigenvalues = true;
  const int states = system.dimension_of(0);
  const Eigen::MatrixXd jacobian = equilibrium_jacobian(system, x).topLeftCorner(states, states);
  const Eigen::VectorXcd values = eigenvalues(jacobian);
  result.valid = values.allFinite();
  if (!result.valid) return result;
  result.values.assign(values.begin(), values.end());
  std::sort(result.values.begin(), result.values.end(), [](const auto& a, const auto& b) {
    return std::make_tuple(-a.real(), -a.imag()) < std::make_tuple(-b.real(), -b.imag());
  });
  return result;
}

HopfPairs hopf_pairs(const std::vector<std::complex<double>>& eigenvalues) {
  HopfPairs pairs;
  for (auto a = eigenvalues.begin(); a != eigenvalues.end(); ++a)
    for (auto b = std::next(a); b != eigenvalues.end(); ++b) {
      const EigenvaluePair pair{*a, *b, 0.0};
      const bool both_real = a->imag() == 0.0 && b->imag() == 0.0;
      const double sizes = std::abs(*a) + std::abs(*b);
      const double distance = sizes > 0.0 ? std::abs(*a + *b) / sizes : 0.0;
      // The sums of other pairs come with their conjugates.
      if ((both_real || pair.is_oscillation()) && (*a + *b).real() < 0.0) pairs.sign = -pairs.sign;
      if (distance < pairs.nearest.distance) pairs.nearest = {*a, *b, distance};
    }
  return pairs;
}

}  // namespace tchat

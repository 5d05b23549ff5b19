/// Where an orbit's critical vectors start, from the starts of its solutions for other multipliers.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

namespace tchat {

/// A q = mu q, p A = mu p of the return map's derivative A: |q| = 1, its entry of largest modulus positive, p q = 1.
struct CriticalStart {
  std::complex<double> multiplier;
  Eigen::VectorXcd right;  ///< q
  Eigen::VectorXcd left;   ///< p
};

/// Of the multiplier nearest to `wanted`, from K = (mu_0 - A)^-1, whose eigenvalues are 1 / (mu_0 - mu); nothing where
/// there is none near it.
std::optional<CriticalStart> critical_start(const Eigen::MatrixXd& k, double mu_0, std::complex<double> wanted);

}  // namespace tchat

/// Eigenvalues of f_x at an equilibrium, in the place of the multipliers of an orbit.
#pragma once

#include "orbit/defining_system.hpp"
#include "stability/multipliers.hpp"

namespace tchat {

/// The n x n matrix f_x of the field of the one segment at the equilibrium x.
Eigen::MatrixXd equilibrium_jacobian(const DefiningSystem& system, const Orbit& x);

/// Of the states that the mode has. Those with the largest real part first; of a conjugate pair the one in the upper
/// half plane first. Not valid where f_x is not finite.
FloquetMultipliers equilibrium_eigenvalues(const DefiningSystem& system, const Orbit& x);

/// Two eigenvalues and how far they are from a sum of zero.
struct EigenvaluePair {
  std::complex<double> first, second;
  double distance = 1.0;  ///< |first + second| / (|first| + |second|)

  /// i omega and -i omega, if the sum is zero; else two real eigenvalues of opposite sign (neutral saddle).
  bool is_oscillation() const { return first.imag() != 0.0 && first == std::conj(second); }
};

/// The pair whose sum is nearest to zero, and the sign of the product of all sums of two: it changes where a pair is on
/// the imaginary axis, and at a neutral saddle. No pair: distance 1, sign 1.
struct HopfPairs {
  EigenvaluePair nearest;
  int sign = 1;
};
HopfPairs hopf_pairs(const std::vector<std::complex<double>>& eigenvalues);

}  // namespace tchat

/// An orbit condensed anew for the coefficients of its normal forms, and corrected on a coarser mesh.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

#include "orbit/condensed_system.hpp"
#include "orbit/defining_system.hpp"
#include "stability/return_map_forms.hpp"

namespace tchat {

class CondensedOrbit {
 public:
  /// For orbits of this shape, which have segments with one mesh in common, that nearly have the multiplier
  /// `critical`: exactly 1, exactly -1, or e^(i theta).
  CondensedOrbit(const DefiningSystem& system, const OrbitShape& shape, std::complex<double> critical);

  /// At x, which stays as it is until the last call of forms(). False where the equations are singular or not finite.
  bool linearise(const Orbit& x);
  ReturnMapForms& forms() { return forms_; }
  /// Of all rows at x, which is linearised, until the next call.
  const RowWeights& residual(const Orbit& x);

  /// Newton's method at the same parameters, or near a fold at a start that moves across q alone, until it no longer
  /// comes nearer: rounding, which the orbit may amplify. False where it fails.
  bool correct(const Eigen::VectorXd& q, Orbit& x);

 private:
  const DefiningSystem& system_;
  std::complex<double> critical_;
  CondensedSystem condensed_;
  ReturnMapForms forms_;
  OrbitResidual residual_;
  RowWeights rows_;
};

}  // namespace tchat

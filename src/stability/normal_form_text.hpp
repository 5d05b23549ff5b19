/// What a label says of its normal form: the coefficient with its uncertainty, and sub- or supercritical. "" at points
/// that have none; where a coefficient cannot be found, why. A verdict is given only where the coefficient is larger
/// than its uncertainty.
#pragma once

#include <complex>
#include <string>

#include "stability/test_function.hpp"

namespace tchat {

/// Of a bifurcation of periodic orbits in one parameter with the multiplier `critical`: 1 (fold), -1 (period doubling)
/// or e^(i theta) (torus).
std::string normal_form_text(const TestedPoint& point, std::complex<double> critical);

/// Of a fold of periodic orbits or of equilibria in one parameter.
std::string fold_text(const TestedPoint& point);

/// Of a branch point of periodic orbits or of equilibria in one parameter: transcritical or pitchfork.
std::string branch_point_text(const TestedPoint& point);

/// Of a point of codimension two on a curve of periodic orbits: cusp, or 1:1 to 1:4 resonance (normal_form.hpp).
std::string codimension_two_text(const TestedPoint& point, PointType type);

/// Of a Hopf bifurcation of equilibria in one parameter with the eigenvalues +- i omega.
std::string hopf_text(const TestedPoint& point, double omega);

}  // namespace tchat

/// What a label says of its normal form: the coefficient with its uncertainty, and sub- or supercritical.
#pragma once

#include <complex>
#include <string>

#include "special_points/test_function.hpp"

namespace tchat {

/// Of a bifurcation of periodic orbits in one parameter with the multiplier `critical`: 1 (fold), -1 (period doubling)
/// or e^(i theta) (torus). "" at other points; where there is no coefficient, why. Says super- or subcritical only
/// where the coefficient is larger than its uncertainty.
std::string normal_form_text(const TestedPoint& point, std::complex<double> critical);

}  // namespace tchat

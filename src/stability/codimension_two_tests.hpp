/// Points of codimension two on curves of folds, period doublings and torus bifurcations of periodic orbits: another
/// multiplier, or pair, is critical too, or the coefficient of the normal form is zero (Kuznetsov, ch. 9).
///
///     curve   a multiplier 1   a multiplier -1   a pair on the circle   coefficient 0
///     LP      -                LPD               LTR                    cusp (curve_tests.hpp)
///     LP of doubled orbits: GPD where their halves meet
///     PD      LPD              -                 PTR                    GPD: c
///     TR      LTR              PTR               TTR                    CH: Re d
///
/// The other curve, or curves, go on there as well. Coefficients are computed only if `coefficients`.
#pragma once

#include "orbit/curve_conditions.hpp"
#include "stability/test_function.hpp"

namespace tchat {

/// LPD and LTR; of doubled orbits GPD.
TestList fold_curve_meetings(const DefiningSystem& system);
/// LPD, PTR and GPD.
TestList doubling_curve_meetings(const DefiningSystem& system, bool coefficients);
/// LTR, PTR, TTR and CH; `pair` is evaluated at the tested point.
TestList torus_curve_meetings(const DefiningSystem& system, const CriticalPair& pair, bool coefficients);

}  // namespace tchat

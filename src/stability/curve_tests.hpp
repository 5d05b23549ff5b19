/// Special points on curves of bifurcations of periodic orbits, codimension-two points among them.
#pragma once

#include "orbit/curve_conditions.hpp"
#include "orbit/monitor_gradient.hpp"
#include "stability/test_function.hpp"

namespace tchat {

// Special points on curves in two or more parameters: cusp and resonances on those of critical multipliers, extrema in
// one more parameter. The test
// functions read the curve's condition, which must outlive them and is evaluated at the tested point.

/// The cusp of a fold curve: the curve's null vector and the gradient of its condition are orthogonal.
/// Of the states where the halves of a doubled orbit begin; of one segment in time.
Eigen::VectorXd differences_of_halves(const Orbit& x, int segments, const CollocationRule& rule);

std::unique_ptr<TestFunction> cusp_test(const CriticalMultiplier& fold, const DefiningSystem& system);

/// The critical multiplier is a double one: 1:1 resonance where it is 1, 1:2 where it is -1, as `type` says.
std::unique_ptr<TestFunction> double_multiplier_test(PointType type, const RealMultiplierCondition& condition);

/// 1:1 to 1:4 resonances on a torus curve.
TestList torus_curve_tests(const CriticalPair& pair);

/// On a curve of extrema: the monitor is stationary in the last parameter too. `names`: of all its parameters.
std::unique_ptr<TestFunction> extremum_test(const StationaryMonitor& condition, std::string names);

/// The curve turns in the free parameter `principal` (from 0) that is called `name`. `type`: fold on grazing curves,
/// where orbits in contact are found up to there and no farther; user on others, on which that is EX.
std::unique_ptr<TestFunction> turning_test(Eigen::Index principal, const std::string& name, PointType type, bool stop);

// Points of codimension two on curves of folds, period doublings and torus bifurcations of periodic orbits: another
// multiplier, or pair, is critical too, or the coefficient of the normal form is zero (Kuznetsov, ch. 9).
//
//     curve   a multiplier 1   a multiplier -1   a pair on the circle   coefficient 0
//     LP      -                LPD               LTR                    cusp (cusp_test())
//     LP of doubled orbits: GPD where their halves meet
//     PD      LPD              -                 PTR                    GPD: c
//     TR      LTR              PTR               TTR                    CH: Re d
//
// The other curve, or curves, go on there as well. Coefficients are computed only if `coefficients`.

/// LPD and LTR; of doubled orbits GPD.
TestList fold_curve_meetings(const DefiningSystem& system);
/// LPD, PTR and GPD.
TestList doubling_curve_meetings(const DefiningSystem& system, bool coefficients);
/// LTR, PTR, TTR and CH; `pair` is evaluated at the tested point.
TestList torus_curve_meetings(const DefiningSystem& system, const CriticalPair& pair, bool coefficients);

}  // namespace tchat

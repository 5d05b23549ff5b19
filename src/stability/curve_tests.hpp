/// Special points on curves in two or more parameters: cusp and resonances on those of critical multipliers, extrema in
/// one more parameter. The test
/// functions read the curve's condition, which must outlive them and is evaluated at the tested point.
#pragma once

#include "orbit/curve_conditions.hpp"
#include "orbit/monitor_gradient.hpp"
#include "stability/test_function.hpp"

namespace tchat {

/// The cusp of a fold curve: the curve's null vector and the gradient of its condition are orthogonal.
std::unique_ptr<TestFunction> cusp_test(const CriticalMultiplier& fold);

/// The critical multiplier is a double one: 1:1 resonance where it is 1, 1:2 where it is -1, as `type` says.
std::unique_ptr<TestFunction> double_multiplier_test(PointType type, const RealMultiplierCondition& condition);

/// 1:1 to 1:4 resonances on a torus curve.
TestList torus_curve_tests(const CriticalPair& pair);

/// On a curve of extrema: the monitor is stationary in the last parameter too. `names`: of all its parameters.
std::unique_ptr<TestFunction> extremum_test(const StationaryMonitor& condition, std::string names);

}  // namespace tchat

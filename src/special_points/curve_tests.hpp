/// Codimension-two points on fold, period-doubling, branch-point and torus curves: cusp and resonances. The test
/// functions read the curve's condition, which must outlive them and is evaluated at the tested point.
#pragma once

#include "bvp/critical_multiplier.hpp"
#include "bvp/critical_pair.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// The cusp of a fold curve: the curve's null vector and the gradient of its condition are orthogonal.
std::unique_ptr<TestFunction> cusp_test(const CriticalMultiplier& fold);

/// The critical multiplier is a double one: 1:1 resonance where it is 1, 1:2 where it is -1, as `type` says.
std::unique_ptr<TestFunction> double_multiplier_test(PointType type, const RealMultiplierCondition& condition);

/// 1:1 to 1:4 resonances on a torus curve.
TestList torus_curve_tests(const CriticalPair& pair);

}  // namespace tchat

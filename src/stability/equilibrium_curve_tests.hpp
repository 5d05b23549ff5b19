/// Codimension-two points on curves of folds, Hopf bifurcations and boundary equilibria. The test functions of the
/// first two read the curve's condition, which must outlive them and is evaluated at the tested point. All are relative
/// and without poles.
#pragma once

#include "orbit/equilibrium_system.hpp"
#include "stability/test_function.hpp"

namespace tchat {

class DefiningSystem;

/// CP, BT and ZH.
TestList equilibrium_fold_tests(const EquilibriumFold& fold);

/// BT, also where the curve meets its mirror image or omega passes 0; ZH and GH.
TestList hopf_curve_tests(const HopfPair& pair);

/// LP on a curve of boundary equilibria of `system`, which outlives it: f_x has the eigenvalue 0, and its range does
/// not contain f_p for both parameters, as at a branch point.
std::unique_ptr<TestFunction> zero_eigenvalue_test(const DefiningSystem& system);

}  // namespace tchat

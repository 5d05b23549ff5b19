/// Codimension-two points on curves of folds and of Hopf bifurcations of equilibria. The test functions read the
/// curve's condition, which must outlive them and is evaluated at the tested point. All are relative and without poles.
#pragma once

#include "bvp/equilibrium_fold.hpp"
#include "bvp/hopf_pair.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// CP, BT and ZH.
TestList equilibrium_fold_tests(const EquilibriumFold& fold);

/// BT, also where the curve meets its mirror image or omega passes 0; ZH and GH.
TestList hopf_curve_tests(const HopfPair& pair);

}  // namespace tchat

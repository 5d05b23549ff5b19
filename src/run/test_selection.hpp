/// Which test functions a run watches: from ILP, ISP, UZR, GCIPSI and the signature.
#pragma once

#include <memory>
#include <vector>

#include "bvp/bordered_problem.hpp"
#include "constants/run_settings.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// `condition` is that of a two-parameter curve, null for none; `curve_type` as in BranchSetup.
std::vector<std::unique_ptr<TestFunction>> select_tests(const DefiningSystem& system, const RunSettings& settings,
                                                        OrbitCondition* condition, int curve_type);

}  // namespace tchat

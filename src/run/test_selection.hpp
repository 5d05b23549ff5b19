/// Which test functions a run watches: from ILP, ISP, UZR, GCIPSI and the signature.
#pragma once

#include <memory>
#include <vector>

#include "bvp/defining_system.hpp"
#include "constants/run_settings.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

std::vector<std::unique_ptr<TestFunction>> select_tests(const DefiningSystem& system, const RunSettings& settings);

}  // namespace tchat

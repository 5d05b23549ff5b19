/// The bounds of a branch as test functions: it ends on them instead of at the first point beyond.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "continuation/continuation_run.hpp"
#include "special_points/test_function.hpp"

namespace tchat {

/// One for each finite bound among RL0, RL1, A0, A1 and BOUNDS: the value minus the bound. Their zeros are end points.
std::vector<std::unique_ptr<TestFunction>> bound_tests(const ContinuationSettings& settings);

}  // namespace tchat

/// Messages about a function of a problem that has no finite value at a state.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"

namespace tchat {

/// "x = 1, v = -0.5": a state by the names of its entries; the first eight of a long one.
std::string named_state(const HybridSystem& system, const double* x);

/// What a user can do about it.
inline constexpr const char* undefined_value_advice =
    "give the function a value there (mind roots and logarithms of negative numbers, and divisions by zero), or let an "
    "event end the motion before";

/// "flow has no finite value at x = 1, v = -0.5; " and the advice.
std::string undefined_value(const HybridSystem& system, FunctionKind kind, int index, const double* x);

}  // namespace tchat

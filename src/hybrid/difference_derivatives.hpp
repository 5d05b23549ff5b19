/// Central differences for problem tables that supply fewer derivatives than are needed (GCIDIFF 0 or 1).
///
/// Same shapes as HybridSystem::first and ::second. No allocation for dimensions up to 64 and 16 active parameters
/// beyond a few stack arrays; larger problems use heap buffers.
#pragma once

#include <span>

#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// F by value, F_x and F_p by central differences of F with step cbrt(eps) (1 + |variable|): error about 1e-10.
void difference_first(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp);

/// D = F_x v + F_p w from first(), its derivatives by central differences of D.
void difference_second(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                       std::span<const int> active, const double* direction, double* out, double* dx, double* dp);

}  // namespace tchat

/// Central differences for problem tables that supply fewer derivatives than are needed (GCIDIFF 0 or 1).
///
/// Same shapes as HybridSystem::first and ::second. A derivative by one variable comes from six values at distances h,
/// 2h, 3h: its error is of order h^6, near rounding / h = 1e-13 where the function varies on a scale of 1. The result
/// is compared with the one of fourth order from the same values; where they disagree or are not finite, h is reduced.
#pragma once

#include <span>

#include "model/hybrid_system.hpp"

namespace tchat {

/// F by value, F_x and F_p by differences of F.
void difference_first(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      std::span<const int> active, double* out, double* dx, double* dp);

/// dF/dPAR(k) by differences of F: `rows` numbers.
void difference_by_parameter(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                             const double* par, int k, double* column);

/// D = F_x v + F_p w, its derivatives by differences of D. D comes from first derivatives where the table has them,
/// else it is itself a difference along (v, w).
void difference_second(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                       std::span<const int> active, const double* direction, double* out, double* dx, double* dp);

/// HybridSystem::third, the third derivatives by a difference of second ones, of fourth order.
void difference_third(const HybridSystem& system, FunctionKind kind, int index, const double* x, const double* par,
                      double* out);

/// The derivatives of the boundary conditions, shapes as in HybridSystem::boundary_first, by differences of them.
void difference_boundary(const HybridSystem& system, const OrbitEnds& at, std::span<const int> active, double* out,
                         double* dstarts, double* dends, double* dp);

}  // namespace tchat

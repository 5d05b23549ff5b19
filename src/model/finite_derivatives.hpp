/// Where a function has a value and no derivatives: sqrt, cbrt, hypot and atan2 at zero, asin and acos at 1 and -1.
#pragma once

#include <Eigen/Core>
#include <string>

#include "model/hybrid_system.hpp"

namespace tchat {

/// "flow has no finite derivatives at x = (0, 0): ...", with what may be the reason.
std::string no_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const Eigen::VectorXd& x);

/// Are the derivatives of function `index` by the states finite at x, wherever its value is? `par` has layout().room()
/// entries. Allocates.
bool has_finite_derivatives(const HybridSystem& system, FunctionKind kind, int index, const double* x,
                            const double* par);

}  // namespace tchat

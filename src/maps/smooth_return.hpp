/// The return of a flow to a section, with jumps on its way, expanded in the start to first or second order:
///
///     Phi' = f_z Phi,    S_ab' = f_z S_ab + f_zz Phi_a Phi_b                (variational equations)
///     z -> Phi(z, T + tau(z)),  h(.) = 0 gives the time tau to each order,  then z -> g(z)
///
/// N states (of a suspended system: with parameters among them), one unknown tau and one equation for each event.
#pragma once

#include <Eigen/Core>

#include "maps/quadratic_map.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

/// Along `path` from z: each index vector's field until its event falls to zero, then its jump (`no_function`: none).
/// Events and their first derivatives are located by CVODES; second derivatives along them by a Runge-Kutta formula of
/// order 7. `par` has the room of the problem's ParameterLayout; `order` is 1 or 2. Throws ComputationError, naming the
/// segment, for what cannot be integrated, an event that does not come, and one that is met tangentially.
QuadraticMap smooth_return(const HybridSystem& system, const Signature& path, const Eigen::VectorXd& z,
                           const Eigen::VectorXd& par, int order, const FlowOptions& options = {});

}  // namespace tchat

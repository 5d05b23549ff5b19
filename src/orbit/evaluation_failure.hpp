/// Which function of the problem could not be evaluated on an orbit, for messages.
#pragma once

#include <string>

#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// The first field, event function or jump whose value or derivatives are not finite at a point where the boundary
/// value problem evaluates it, with its index, place and state; empty when there is none.
std::string evaluation_failure(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x);

/// The same for one function at one state, tau on segment s (from 0).
std::string function_failure(const DefiningSystem& system, FunctionKind kind, int index, int s, double tau,
                             const double* x, const double* par);

}  // namespace tchat

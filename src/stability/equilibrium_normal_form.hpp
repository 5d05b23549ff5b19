/// Normal forms of equilibria with an eigenvalue 0: folds and branch points (Kuznetsov, Elements of Applied Bifurcation
/// Theory, 3rd ed., 5.4; branching.hpp). With A = f_x, A q = lambda q, p A = lambda p for the eigenvalue lambda nearest
/// to 0, p q = 1, |q| = 1 and the entry of q of largest modulus positive,
///
///     fold     a = p f_xx(q, q) / 2,     y' = p f_p s + a y^2
///     branch point: F = f, V = q, W = -p, b = -q, r = q', so that g is the rate of y.
#pragma once

#include <optional>

#include "orbit/defining_system.hpp"
#include "stability/branching.hpp"

namespace tchat {

/// a at a fold. Nothing where the eigenvalue nearest to 0 is complex or not simple. The place on the branch (EPSS) is
/// not in its uncertainty. Allocates.
std::optional<Coefficient> equilibrium_fold_form(const DefiningSystem& system, const Orbit& x);

/// Nothing where no branch crosses. Allocates.
std::optional<BranchingForm> equilibrium_branching(const DefiningSystem& system, const Orbit& x);

}  // namespace tchat

/// The first Lyapunov coefficient of a Hopf bifurcation: which way the periodic orbits go that are born there.
#pragma once

#include "orbit/defining_system.hpp"
#include "stability/multilinear.hpp"

namespace tchat {

/// l_1 at an equilibrium with the eigenvalues +- i omega, by the multilinear forms B and C of f (Kuznetsov, Elements of
/// Applied Bifurcation Theory, 5.4),
///
///     2 omega l_1 = Re ( p' C(q, q, q*) - 2 p' B(q, A^-1 B(q, q*)) + p' B(q*, (2 i omega - A)^-1 B(q, q)) ),
///
/// with A q = i omega q, A' p = -i omega p, |q| = 1, p' q = 1. B and C are as exact as the problem gives them: where C
/// is a difference of second derivatives it is good to about 1e-8. Negative: the orbits are stable on the side where
/// the equilibrium is not (supercritical). Not a number where it cannot be found. Allocates.
Coefficient first_lyapunov_coefficient(const DefiningSystem& system, const Orbit& x, double omega);

}  // namespace tchat

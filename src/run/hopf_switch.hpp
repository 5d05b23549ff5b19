/// ISW = -1 at a Hopf bifurcation: from the equilibrium to the first periodic orbit.
///
/// With f_x v = i omega v the orbits of small amplitude e are
///
///     x(tau) = x* + e Re(v exp(2 pi i tau)) + O(e^2),     T = 2 pi / omega + O(e^2),
///
/// tau from 0 to 1. The first one is corrected on the plane across d = Re(v exp(2 pi i tau)), <d, x - x*> = e, which no
/// equilibrium meets, with e = |DS|, or less where that does not converge: both signs of DS are the same orbits, begun
/// half a turn later. With a section the phase of v is chosen so that the orbit ends on it, going the way that ends
/// segments; without one the phase condition keeps it.
#pragma once

#include "run/branch_setup.hpp"

namespace tchat {

/// Throws UserError when the label is no equilibrium, has no pair of eigenvalues on the imaginary axis, or the
/// signature is not one segment whose section, if it has one, the orbits cross; ComputationError when no orbit is
/// found.
BranchSetup begin_periodic_orbits(const HybridSystem& system, const RunSettings& settings,
                                  const SelectedStart& selected);

/// omega of the oscillation that MODE chooses, 1: the slowest. Throws UserError where there are not so many, with a
/// list.
double chosen_frequency(const DefiningSystem& equilibria, const Orbit& x, const SelectedStart& selected, int mode);

}  // namespace tchat

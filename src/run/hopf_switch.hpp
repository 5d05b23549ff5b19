/// Branch switching (ISW = -1) at Hopf bifurcations and at points of codimension two.
#pragma once

#include "run/branch_setup.hpp"

namespace tchat {

// ISW = -1 at a Hopf bifurcation: from the equilibrium to the first periodic orbit.
//
// With f_x v = i omega v the orbits of small amplitude e are
//
//     x(tau) = x* + e Re(v exp(2 pi i tau)) + O(e^2),     T = 2 pi / omega + O(e^2),
//
// tau from 0 to 1. The first one is corrected on the plane across d = Re(v exp(2 pi i tau)), <d, x - x*> = e, which no
// equilibrium meets, with e = |DS|, or less where that does not converge: both signs of DS are the same orbits, begun
// half a turn later. With a section the phase of v is chosen so that the orbit ends on it, going the way that ends
// segments; without one the phase condition keeps it.

/// Throws UserError when the label is no equilibrium, has no pair of eigenvalues on the imaginary axis, or the
/// signature is not one segment whose section, if it has one, the orbits cross; ComputationError when no orbit is
/// found.
BranchSetup begin_periodic_orbits(const HybridSystem& system, const RunSettings& settings,
                                  const SelectedStart& selected);

/// omega of the oscillation that MODE chooses, 1: the slowest. Throws UserError where there are not so many, with a
/// list.
double chosen_frequency(const DefiningSystem& equilibria, const Orbit& x, const SelectedStart& selected, int mode);

// ISW = -1 at a point of codimension two: the curve in two parameters that begins there, of orbits that are born there
// (Kuznetsov, Elements of Applied Bifurcation Theory, sections 8.3, 8.5, 8.6, 9.4, 9.5).
//
//     GPD       folds of doubled orbits
//     R2        torus bifurcations of doubled orbits
//     GH        folds of periodic orbits
//     ZH, HH    torus bifurcations of periodic orbits
//
// Near the point the curve is x = x* + e d + O(e^2), with parameters that are those of the point + O(e^2), where d is
// the critical direction of the period doubling, or the oscillation. An orbit of amplitude e, |DS| or less, is found
// first, with one parameter free (branch_switch.hpp, begin_periodic_orbits()). It is corrected onto the curve on the
// plane across d, so that e stays: n m + m + 2 unknowns, the conditions of an orbit, that of the curve and the plane.

/// Folds. Throws UserError where the label cannot be left so (begin_periodic_orbits(), switch_branch()),
/// ComputationError when no orbit, or none of the curve, is found near the label.
BranchSetup begin_fold_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

/// Torus bifurcations. The same; throws NothingBegins where the orbits have no pair of multipliers that is complex.
BranchSetup begin_torus_curve(const HybridSystem& system, const RunSettings& settings, const SelectedStart& selected);

}  // namespace tchat

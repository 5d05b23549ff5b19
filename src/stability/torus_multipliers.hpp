/// Normal stability of an invariant torus: the mean growth of perturbations per return, along the rotation.
///
/// Perturbations of the curve u(phi) of a return map go by v(phi + rho) = A(phi) v(phi), A the derivative of the return
/// map at u(phi). Where that is reducible, v = C(phi) y with y -> B y, the multipliers of B say what becomes of
/// perturbations, up to whole multiples of rho in their angles: their moduli are all there is. They are
///
///     |mu_k| = exp lambda_k,   lambda_k the Lyapunov exponents of the sequence A(phi_0 + j rho), j = 0, 1, ...
///
/// found by orthogonalisation (QR) at each return, of a frame whose first vector is u'(phi): that direction goes to
/// itself, and those across it are told from it also where they grow as little, near the birth of the torus. The mean
/// of log R_kk is weighted by exp(-1 / (t (1 - t))) over the sequence, with which means of functions on a circle
/// converge faster than any power of its length [Das, Saiki, Sander, Yorke, Nonlinearity 30 (2017) 4111]. A is
/// interpolated between the N orbits. One of them is 1, along the curve; its distance from that is an error figure.
/// Another is 0, along the flow.
#pragma once

#include "orbit/torus_system.hpp"
#include "stability/multipliers.hpp"

namespace tchat {

class CondensedSystem;

/// exp lambda_k, that along the curve first, then the largest: `states` - 1 of them, of the mode with the fewest states
/// (at least 2), for the others are zero. Column i of `matrices` holds A at the phase i / N, n n
/// entries; `curve`: u(phi) - w phi at these phases, n x N; `w`: what a turn of phi adds to the states. Entries of
/// `matrices` that are not finite spoil the result.
Eigen::VectorXd moduli_along_rotation(const Eigen::MatrixXd& matrices, const Eigen::MatrixXd& curve,
                                      const Eigen::VectorXd& w, double rho, int states);

/// Moduli as FloquetMultipliers orders them: that along the curve first, as the trivial one, the structural zero last.
/// Not valid where a section is touched, h_x f = 0. `condensed` holds the linearisation of `system` at x.
FloquetMultipliers torus_multipliers(const TorusSystem& system, const CondensedSystem& condensed, const Orbit& x);

}  // namespace tchat

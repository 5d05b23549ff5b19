/// How far collocation polynomials are from the orbit that they stand for, seen by their residual.
///
/// On an interval of length h in tau the polynomial p(sigma) of degree c satisfies the equations at the c Gauss points;
/// between them r(sigma) = p'(sigma) - h T f(p(sigma)) does not vanish. Where the mesh resolves the orbit, r is Pi, the
/// polynomial with its zeros at the Gauss points, times a constant, and the error that arises on the interval is
///
///     e(sigma) = integral of r from 0 to sigma,    |e| <= |r(0)| max |integral of Pi| / |Pi(0)|,
///
/// which is h^(c+1) |u^(c+1)| times a constant (Ascher, Mattheij and Russell, Numerical Solution of Boundary Value
/// Problems, 5.4). Where it does not, derivatives of p say nothing of those of the orbit, but r still says how far p is
/// from a solution. The ends of the intervals are looked at, where |r| is largest. Collocation does not ask for the
/// field there: where it has no value, as a root on a surface has none, the other ends tell.
#pragma once

#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

/// The largest |e| of all intervals and components, relative to 1 + max |u|; 0 for equilibria, infinite where a state
/// is not finite. Segments of zero duration have none.
double estimated_error(const HybridSystem& system, const Signature& signature, const Orbit& x,
                       const CollocationRule& rule);

}  // namespace tchat

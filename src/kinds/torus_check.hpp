/// An invariant torus against forward integration: every return from the N stored orbits, and from the N phases half
/// way between them, is integrated segment by segment (segment_check.hpp) and must land on the curve a rotation
/// further, g(x(1)) = u(phi + rho). Half way between, that is what the trigonometric polynomial of Q harmonics leaves
/// out.
#pragma once

#include "kinds/orbit_check.hpp"

namespace tchat {

/// `one_return`: the constants of the run; `x`: the N orbits one after the other. A segment of the result is one of the
/// return: the worst of it over all phases, its mean duration. `stored`: the moduli of the multipliers in the d-file;
/// they are compared with moduli_along_rotation() (stability/floquet_multipliers.hpp) of the integrated return maps. A
/// return map that ends in contact has no derivative, and no multipliers are compared then.
OrbitCheck check_torus(const HybridSystem& system, const RunSettings& one_return, const Orbit& x,
                       const std::vector<std::complex<double>>& stored, double tolerance);

}  // namespace tchat

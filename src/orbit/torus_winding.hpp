/// States of a torus that are angles, counted modulo 2 pi.
///
/// A state is an angle for a return where 2 pi more of it changes nothing: neither the fields nor the event functions,
/// and of the jumps nothing but the same 2 pi. Along a torus it may go round: then the curve u(phi) of a section does
/// not close, and a return may end whole turns further,
///
///     u(phi + 1) = u(phi) + w,     P(u(phi)) = u(phi + rho) + c,     w and c whole multiples of 2 pi.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

struct TorusWinding {
  Eigen::VectorXd curve;    ///< w, n
  Eigen::VectorXd returns;  ///< c, n
};

TorusWinding no_winding(int dimension);

/// The angles among the states, from 0: what is said above, seen at the columns of `samples` (n x K).
std::vector<Eigen::Index> angle_states(const HybridSystem& system, const Signature& one_return,
                                       const Eigen::MatrixXd& samples, const Eigen::VectorXd& par);

/// Of an angle at N equal phases: that multiple of 2 pi with which the last harmonics of u - w phi are least.
double likely_winding(const Eigen::VectorXd& values);

/// Of N orbits of one return each.
TorusWinding torus_winding(const HybridSystem& system, const Signature& one_return, const Orbit& x);

}  // namespace tchat

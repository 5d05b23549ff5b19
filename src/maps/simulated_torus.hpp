/// Tori that a simulation follows, as starts of continuations, and the command `tchat simulate --torus`.
#pragma once

#include <functional>
#include <ostream>
#include <vector>

#include "maps/invariant_curve.hpp"
#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "orbit/orbit.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

// A torus that a simulation goes round, as the start of a continuation: the orbits of orbit/torus_system.hpp from
// points of a section.

/// A segment of the simulated motion: what ended it, and where it began.
struct PassedSegment {
  IndexVector index;
  Eigen::VectorXd start;
};

/// The states in which returns of the signature begin, n x K, in their order. Throws UserError, `source` in front,
/// where the motion does not go by the signature again and again, with the segment where it leaves it.
Eigen::MatrixXd points_of_returns(const std::vector<PassedSegment>& motion, const Signature& one_return,
                                  const std::string& source);

/// Points whose angles (orbit/torus_system.hpp) are counted modulo 2 pi, and which of these go round: n x K.
struct PointsWithAngles {
  Eigen::MatrixXd points;
  std::vector<Eigen::Index> winding;  ///< states, from 0; the other angles go to and fro
};
PointsWithAngles with_angles(const HybridSystem& system, const Signature& one_return, Eigen::MatrixXd points,
                             const ParameterVector& par);

/// So many returns, and the uniform mesh of each segment.
struct TorusMesh {
  int orbits, intervals, collocation;
};

/// Returns from equal phases of the curve, integrated; PAR with rho and the durations. `longest`: no segment lasts
/// longer; `sizes`: of the states. Throws ComputationError where one cannot be integrated.
Orbit orbits_from_curve(const HybridSystem& system, const Signature& one_return, const InvariantCurve& curve,
                        const ParameterVector& par, const TorusMesh& mesh, double longest,
                        const Eigen::VectorXd& sizes);

// `tchat simulate --torus`: from the points in which a simulated motion begins its returns to the start of a run of
// tori, a label in q.NAME2 and constants in gc.NAME2.

/// Exit status. The motion is simulated as the plan says, 1500 returns after 500 where it says nothing. Throws
/// UserError where there is no signature, the motion does not go by it, or its points lie on no closed curve;
/// ComputationError.
int simulate_torus(const SimulationRequest& request, const std::string& torus_name, std::ostream& screen,
                   std::ostream& warnings, const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat

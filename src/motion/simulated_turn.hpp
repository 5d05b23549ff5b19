/// One turn of a simulation, from the state in which an event is met to that of a later one, with its derivative.
///
///     y -> R(y),   M = R_y = P_m Phi_m g_{k_{m-1},x} ... P_1 Phi_1 g_{k_m,x},   P_s = Id - f h_x / (h_x f)    (2.26)
///
/// States are those before the jumps; Phi_s is the Jacobian of the flow over segment s, k_m the jump of the event that
/// the simulation has just met. All events that the simulation watches are watched.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/index_vector.hpp"
#include "motion/hybrid_simulation.hpp"

namespace tchat {

struct SimulatedTurn {
  std::vector<SimulatedSegment> segments;
  Eigen::MatrixXd derivative;  ///< M, n x n; empty when it was not wanted
  std::string fault;           ///< why there is no such turn; "" when there is
  bool is_smooth = true;       ///< false: the fault is that a derivative does not exist

  const Eigen::VectorXd& end() const { return segments.back().end; }  ///< R(y), n
};

/// From the last event of `at`, met in the state y, as long as segments end by `expected`. A segment that ends
/// otherwise, or tangentially where the derivative is wanted, is a fault.
SimulatedTurn simulate_turn(const HybridSimulation& at, const Eigen::VectorXd& y, const Signature& expected,
                            SimulationSettings settings, bool with_derivative);

}  // namespace tchat

/// Whether a trajectory converges to an equilibrium of its field.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/hybrid_system.hpp"
#include "motion/hybrid_simulation.hpp"

namespace tchat {

/// An equilibrium whose f_x has no eigenvalue with a positive real part, found by Newton's method from the end of a
/// motion that has had no event for so long (SegmentEnd::no_event) that its speed times that duration is nothing.
/// States that nothing depends on (`ignorable`, from 0) keep their values, and may move.
std::optional<Eigen::VectorXd> reached_equilibrium(const HybridSystem& system, const SimulatedSegment& last,
                                                   const Eigen::VectorXd& par,
                                                   const std::vector<Eigen::Index>& ignorable);

/// Such an equilibrium that states at events of one kind, in the order of time, converge to: each of the last `least`
/// of them, or of more, is nearer than the one before it, or there to 1e-8. The surface of the event goes through it,
/// as no state on the surface could come near it otherwise. Where they are not there yet, the distances fall by more
/// than errors of the integration may make of a motion that keeps its energy, and their limit by Aitken's formula, from
/// three of them at equal spaces, is below half of the last one: else they may come to a cycle round the equilibrium.
/// Slow convergence, as 1/t, is not told from that.
std::optional<Eigen::VectorXd> approached_equilibrium(const HybridSystem& system, const IndexVector& index,
                                                      const std::vector<Eigen::VectorXd>& states, std::size_t least,
                                                      const Eigen::VectorXd& par,
                                                      const std::vector<Eigen::Index>& ignorable);

}  // namespace tchat

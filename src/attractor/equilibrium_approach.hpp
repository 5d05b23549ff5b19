/// Whether a motion comes to rest: an equilibrium of its field, found by Newton's method from where the motion is.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hybrid/hybrid_system.hpp"
#include "simulation/hybrid_simulation.hpp"

namespace tchat {

/// x with f_i(x, p) = 0 near a state, whose f_x has no eigenvalue with a positive real part; nothing where Newton's
/// method does not converge. States that nothing depends on (`ignorable`, from 0) keep their values, and may move.
std::optional<Eigen::VectorXd> attracting_equilibrium(const HybridSystem& system, int field,
                                                      const Eigen::VectorXd& near, const Eigen::VectorXd& par,
                                                      const std::vector<Eigen::Index>& ignorable);

/// Such an equilibrium where a motion is that has had no event for so long (SegmentEnd::no_event): its speed times that
/// duration is nothing.
std::optional<Eigen::VectorXd> reached_equilibrium(const HybridSystem& system, const SimulatedSegment& last,
                                                   const Eigen::VectorXd& par,
                                                   const std::vector<Eigen::Index>& ignorable);

/// Such an equilibrium that states at events of one kind, in the order of time, approach: each is nearer than the one
/// before it, or there to 1e-8.
std::optional<Eigen::VectorXd> approached_equilibrium(const HybridSystem& system, int field,
                                                      const std::vector<Eigen::VectorXd>& states,
                                                      const Eigen::VectorXd& par,
                                                      const std::vector<Eigen::Index>& ignorable);

}  // namespace tchat

/// On which side of an event a simulation begins whose first state lies on that event's surface, h_j = 0, with h_j
/// falling: before the event, which then happens at once, or after it.
///
/// The state alone cannot decide. If the jump sends it to a point of the surface where h_j falls again, as the heel
/// strike of a walker does, it is taken as a state after the event. If the jump takes it off the surface, as the reset
/// of a clock does, or sends the flow back, as a wall does, it is taken as a state before the event.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "motion/mode_rule.hpp"

namespace tchat {

/// The start of a simulation counts as on the surface up to |h_j| = start_tolerance sum_i |h_x,i x_i|, wherever the
/// state is known to be one after the event or may be: states are typed with few digits.
constexpr double start_tolerance = 1e-4;

struct StartSide {
  enum class Given {
    nothing,  ///< the jump decides, as above
    after,    ///< of `event`, or of any event that is no wall if `event` is 0
    before,
  } given = Given::nothing;
  int event = 0;
};

/// An event on whose surface the simulation begins, with h_j falling.
struct SurfaceStart {
  IndexVector index;
  double h = 0.0;
  bool is_after = false;      ///< false: the event happens at once
  bool is_undecided = false;  ///< nothing was given, and the jump decided
};

/// Does the jump send the flow back from the surface, as an impact does?
bool reverses_flow(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x,
                   const Eigen::VectorXd& par);
/// Does the jump take the state from the surface to another place? `rounding` is relative.
bool moves_state(const HybridSystem& system, const IndexVector& index, const Eigen::VectorXd& x,
                 const Eigen::VectorXd& par, double rounding);

/// Of the index vectors of `mode`, the first one of `rule`, at the start x. |h| / (1 + |h_x| |x|) up to `rounding` is
/// zero.
std::vector<SurfaceStart> surface_starts(const ModeRule& rule, const Mode& mode, const Eigen::VectorXd& x,
                                         const Eigen::VectorXd& par, const StartSide& side, double rounding);

}  // namespace tchat

/// `tchat simulate --torus`: from the points in which a simulated motion begins its returns to the start of a run of
/// tori, a label in q.NAME2 and constants in gc.NAME2.
#pragma once

#include <functional>
#include <ostream>

#include "simulate/simulation_request.hpp"

namespace tchat {

/// Exit status. The motion is simulated as the plan says, 1500 returns after 500 where it says nothing. Throws
/// UserError where there is no signature, the motion does not go by it, or its points lie on no closed curve;
/// ComputationError.
int simulate_torus(const SimulationRequest& request, const std::string& torus_name, std::ostream& screen,
                   std::ostream& warnings, const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat

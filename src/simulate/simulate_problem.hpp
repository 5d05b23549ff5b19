/// `tchat simulate` without the command line: constants -> plugin -> start -> simulation -> orbit -> files.
#pragma once

#include <functional>
#include <ostream>

#include "simulate/simulation_request.hpp"

namespace tchat {

/// Simulates, writes O.trajectory and O.events, with hand_over also NAME2.dat and gc.NAME2; prints a summary to
/// `screen` (nothing when quiet). `progress`, if given, is told about long work. Returns 0; 1 when hand_over was asked
/// and there is no periodic orbit, or the integration failed. Throws UserError for what is wrong with the input,
/// ComputationError when files cannot be written.
int simulate_problem(const SimulationRequest& request, std::ostream& screen, std::ostream& warnings,
                     const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat

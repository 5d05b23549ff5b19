/// `tchat sweep --map` without the command line: grazing orbit or torus -> composite map -> job -> O.sweep.
#pragma once

#include "maps/map_request.hpp"
#include "simulate/sweep_request.hpp"
#include "simulate/sweep_setup.hpp"

namespace tchat {

/// As sweep_problem(): the same files, parts, workers and summary. Throws UserError, also for options of simulations
/// that a map has no use for, and ComputationError.
int map_sweep_problem(const SweepRequest& request, const MapRequest& map, const SweepConsole& console);

}  // namespace tchat

/// `tchat sweep --map` without the command line: grazing orbit or torus -> composite map -> job -> O.sweep.
#pragma once

#include <functional>
#include <ostream>

#include "map_sweep/map_request.hpp"
#include "sweep/sweep_request.hpp"

namespace tchat {

/// As sweep_problem(): the same files, parts, workers and summary. Throws UserError, also for options of simulations
/// that a map has no use for, and ComputationError.
int map_sweep_problem(const SweepRequest& request, const MapRequest& map, std::ostream& screen, std::ostream& warnings,
                      const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat

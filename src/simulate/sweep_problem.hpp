/// `tchat sweep` by simulation, without the command line: constants, plugin, starts -> job -> O.sweep.
#pragma once

#include "simulate/sweep_request.hpp"
#include "simulate/sweep_setup.hpp"

namespace tchat {

/// Prints a summary to the screen (nothing when quiet). Returns 0, also when it was interrupted, which the summary
/// says. Throws UserError for what is wrong with the input, ComputationError when files cannot be written.
int sweep_problem(const SweepRequest& request, const SweepConsole& console);

}  // namespace tchat

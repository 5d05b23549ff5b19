/// `tchat sweep` by simulation, without the command line: constants, plugin, starts -> job -> O.sweep.
#pragma once

#include <functional>
#include <ostream>

#include "sweep/sweep_request.hpp"

namespace tchat {

/// Prints a summary to `screen` (nothing when quiet). Returns 0, also when it was interrupted, which the summary says.
/// Throws UserError for what is wrong with the input, ComputationError when files cannot be written.
int sweep_problem(const SweepRequest& request, std::ostream& screen, std::ostream& warnings,
                  const std::function<bool()>& interrupted, std::ostream* progress);

}  // namespace tchat

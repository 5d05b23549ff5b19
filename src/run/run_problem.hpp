/// `tchat run` without the command line: constants -> plugin -> start -> discretisation -> continuation -> files.
#pragma once

#include <functional>
#include <ostream>

#include "files/run_files.hpp"

namespace tchat {

/// Does the run, printing to `screen` (table and summary; nothing when quiet) and `warnings`. `interrupted` is asked
/// after every point. `progress` may be a terminal, on which a compilation of the plugin is told, and where the branch
/// is.
///  Returns 0 when a branch was computed, 1 when its first step failed. Throws UserError for what is
/// wrong with the input, ComputationError when the first point does not converge or files cannot be written.
int run_problem(const RunRequest& request, std::ostream& screen, std::ostream& warnings,
                const std::function<bool()>& interrupted, std::ostream* progress = nullptr);

}  // namespace tchat

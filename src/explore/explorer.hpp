/// The whole diagram that other commands can reach: attractors of a sweep as starts, branches from them in both
/// directions, and at every special point the command that most users give next (run/run_remarks.hpp), until nothing
/// new is found.
///
/// Work goes in rounds: all commands of a round are known when it begins, and what they found is looked at in their
/// order. The diagram does not depend on how many are done at a time, nor on interruptions.
#pragma once

#include <functional>
#include <ostream>

#include "explore/exploration_commands.hpp"
#include "explore/explored_diagram.hpp"

namespace tchat {

/// Writes the files of branches to the folder O, O.txt (the tree), O.json and Makefile.O. `progress` may be null.
/// Returns 0, or 1 when no attractor gave a branch. Throws UserError, ComputationError.
int explore(const ExploreRequest& request, const std::function<bool()>& interrupted, std::ostream& screen,
            std::ostream* progress);

}  // namespace tchat

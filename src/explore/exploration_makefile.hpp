/// The Makefile that makes the files of an exploration by plain commands.
#pragma once

#include <string>
#include <vector>

#include "explore/command_job.hpp"

namespace tchat {

/// `jobs` come after those that make their inputs, and before `last` ones. Target `branches` makes the files of `jobs`,
/// `all` those of both, `part` a part of PARTS of the branches, number PART from 1: no file belongs to two parts, so
/// that parts can be made at the same time by processes that know nothing of each other.
std::string exploration_makefile(const std::vector<CommandJob>& jobs, const std::vector<CommandJob>& last,
                                 const std::string& folder);

}  // namespace tchat

/// A branch as JSON, for the script of a page: the values of every point, labels, multipliers, orbits, and the command
/// that restarts at a label.
#pragma once

#include <string>

#include "files/branch_file.hpp"

namespace tchat {

struct PageBranchOptions {
  std::string plugin;  ///< -p: the problem in the restart command
  int dimension = 0;   ///< of one segment, where the q-file does not say
};

/// Numbers have the digits of the files. What is missing is explained under "noOrbits", "noMultipliers".
std::string branch_json(const BranchFile& file, const PageBranchOptions& options);

}  // namespace tchat

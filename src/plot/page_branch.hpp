/// Branches as JSON for the script of a page: points, labels, orbits, and the commands that continue from labels.
#pragma once

#include <map>
#include <string>

#include "files/branch_file.hpp"

namespace tchat {

// The command that goes on from a labelled solution, as a line for a shell.

/// `tchat run PROBLEM -c r.NAME -s NAME -o NAME_LABEL IRS=LABEL`, in two parts that are each followed by the label.
struct RestartCommand {
  std::string to_output;  ///< up to the name of the new run, which ends in the label
  std::string to_label;   ///< from there to IRS=
  std::string remark;     ///< what the user has to fill in, or why there is no command; "" where it can be pasted

  bool exists() const { return !to_output.empty(); }
  std::string from(const std::string& label) const { return to_output + label + to_label + label; }
};

/// For labels of the q-file beside the branch. No file says which problem it is of: that is `plugin` (-p), or the
/// plugin with the name of the run, or the only plugin in the folder; otherwise the word PROBLEM.
RestartCommand restart_command(const BranchFile& file, const std::string& plugin);

// The labelled solutions of a branch as JSON, for the script of a page: states in time, with events and jumps.

struct PageOrbits {
  std::string json;                  ///< a list, one entry for each solution that is embedded
  std::map<int, std::size_t> place;  ///< by label: where in the list
  std::string missing;               ///< why there are none, or not all of them; "" where all are there
};

/// Of the q-file beside the branch. Long orbits are thinned, and of many labels all special points and an even choice
/// of the others are embedded, so that a page stays small. `dimension`: states of one segment where the file does not
/// say (0: it does). A q-file that is missing or cannot be read leaves the list empty.
PageOrbits page_orbits(const BranchFile& file, int dimension);

// A branch as JSON, for the script of a page: the values of every point, labels, multipliers, orbits, and the command
// that restarts at a label.

struct PageBranchOptions {
  std::string plugin;  ///< -p: the problem in the restart command
  int dimension = 0;   ///< of one segment, where the q-file does not say
};

/// Numbers have the digits of the files. What is missing is explained under "noOrbits", "noMultipliers".
std::string branch_json(const BranchFile& file, const PageBranchOptions& options);

}  // namespace tchat

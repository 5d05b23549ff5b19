/// The command that goes on from a labelled solution, as a line for a shell.
#pragma once

#include <string>

#include "files/branch_file.hpp"

namespace tchat {

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

}  // namespace tchat

/// `tchat verify` without the command line: q-file, constants of its run and plugin -> a table of defects.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace tchat {

struct VerifyRequest {
  std::string solutions;                 ///< q-file, by path or by the name of its run
  std::vector<std::string> labels;       ///< numbers, or types with a count; empty: all
  std::optional<std::string> constants;  ///< -c; default the r-file beside the q-file
  std::optional<std::string> problem;    ///< -p; default the name of the q-file
  double tolerance = 1e-6;
};

/// True when every label is, to the tolerance, what forward integration makes of it (or is inadmissible and the d-file
/// says so). Throws UserError for what is wrong with the input.
bool verify_solutions(const VerifyRequest& request, std::ostream& screen, std::ostream& warnings);

}  // namespace tchat

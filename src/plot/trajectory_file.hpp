/// NAME.trajectory of `tchat simulate`, or the table that `tchat orbit` prints, as an orbit that need not close.
#pragma once

#include <string>
#include <vector>

#include "files/orbit_trace.hpp"

namespace tchat {

struct TrajectoryFile {
  OrbitTrace trace;                 ///< named NAME; its parameters are those of the heading
  std::vector<std::string> states;  ///< from the heading, blanks as underscores
};

/// Throws UserError with the line for what is no trajectory, or holds no rows.
TrajectoryFile read_trajectory_file(const std::string& path);

}  // namespace tchat

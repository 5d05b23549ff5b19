/// Which points of a run are orbits of the model.
#pragma once

#include <map>
#include <string>

namespace tchat {

struct AdmissiblePoints {
  int points = 0, inadmissible = 0;
  /// Are all points inadmissible but the first one of each direction?
  bool only_at_start = false;
  std::map<int, bool> labels;  ///< is the orbit of a label admissible?
};

/// Of a d-file. Throws UserError where it cannot be read.
AdmissiblePoints admissible_points(const std::string& path);

}  // namespace tchat

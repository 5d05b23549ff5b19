/// What is known about a converged point besides the orbit.
#pragma once

#include <optional>
#include <vector>

#include "stability/floquet_multipliers.hpp"

namespace tchat {

struct PointData {
  FloquetMultipliers multipliers;
  std::vector<double> transversalities;       ///< h_x f / (|h_x| |f|) at the end of each segment
  double singular_distance = 1.0;             ///< as in TestedPoint
  std::vector<std::optional<double>> values;  ///< of the test functions
  std::vector<double> zero_levels;
  std::vector<std::string> details;  ///< of a labelled point
  std::vector<int> signs;            ///< of the values; 0 for those up to the zero level
};

}  // namespace tchat

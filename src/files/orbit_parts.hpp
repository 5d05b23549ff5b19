/// Parts of a motion, one for each segment of an orbit, each with times of its own, as starting data.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "files/dat_file.hpp"

namespace tchat {

struct OrbitPart {
  std::vector<double> times;  ///< rising
  Eigen::MatrixXd states;     ///< n x times.size()

  double duration() const { return times.back() - times.front(); }
};

/// The part that begins with `first` and goes on with `second`, whose times are moved to the end of `first`; the first
/// row of `second` is left out.
OrbitPart joined(const OrbitPart& first, const OrbitPart& second);

/// The data of an orbit with these segments: the relative times of all parts together, states between rows by linear
/// interpolation, and the durations. A part of one row lasts no time. `parts` is not empty.
DatFile data_of_parts(const std::vector<OrbitPart>& parts);

}  // namespace tchat

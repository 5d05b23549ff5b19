/// The rows of NAME.trajectory (`tchat simulate`), or of the table that `tchat orbit` prints, segment by segment.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/index_vector.hpp"

namespace tchat {

/// A part of a motion between two events.
struct RecordedRows {
  IndexVector index{no_function, no_function, no_function};  ///< what ended it; all zero where the table does not say
  std::vector<double> times;
  Eigen::MatrixXd states;  ///< n x times.size()
};

struct TrajectoryRows {
  std::vector<std::string> states;                         ///< names from the heading, blanks as underscores
  std::vector<std::pair<std::string, double>> parameters;  ///< of the heading: all of a simulation, PAR(1) first
  std::vector<RecordedRows> segments;
};

/// k of "PAR(k)", the name of a parameter that has none.
std::optional<int> unnamed_parameter(const std::string& name);

/// Does the heading of the file name such columns?
bool looks_like_trajectory(const std::string& path);

/// Throws UserError with the line for what is no trajectory, or holds no rows.
TrajectoryRows read_trajectory_rows(const std::string& path);

}  // namespace tchat

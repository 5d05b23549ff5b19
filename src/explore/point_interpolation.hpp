/// The points of a branch or curve between those that were computed.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tchat {

struct InterpolatedPoint {
  Eigen::VectorXd numbers;
  Eigen::VectorXd uncertainty;  ///< of each: cubic compared with quadratic interpolation
};

/// The numbers of the point between points i and i + 1 whose coordinate is `at`. `coordinate` has that of each point,
/// and differs between these two; `numbers` has a column for each point.
InterpolatedPoint interpolate(const std::vector<double>& coordinate, const Eigen::MatrixXd& numbers, Eigen::Index i,
                              double at);

/// Are these the numbers of the point, up to its uncertainty and the errors of runs?
bool agrees(const InterpolatedPoint& point, const Eigen::VectorXd& numbers);

}  // namespace tchat

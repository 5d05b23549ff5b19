/// A refined periodic orbit as rows of a .dat file: all segments at common times tau of [0, 1], dense where any of them
/// changes fast.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/found_orbit.hpp"

namespace tchat {

struct OrbitSamples {
  std::vector<double> tau;  ///< rising, from 0 to 1
  Eigen::MatrixXd states;   ///< (n m) x tau.size(), segment 1's states first
};

/// `rows` rows; half of their density follows time, half the arclength of all segments, each state scaled by its range.
OrbitSamples sample_orbit(const HybridSystem& system, const FoundOrbit& orbit, const Eigen::VectorXd& par, int rows);

}  // namespace tchat

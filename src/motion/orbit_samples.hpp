/// A refined periodic orbit as rows of a .dat file: all segments at common times tau of [0, 1], on the mesh that a
/// continuation is to begin with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "motion/found_orbit.hpp"

namespace tchat {

struct OrbitSamples {
  std::vector<double> tau;  ///< rising, from 0 to 1: every mesh interval in 2 c equal parts
  Eigen::MatrixXd states;   ///< (n m) x tau.size(), segment 1's states first
  int intervals = 0;        ///< of the mesh
  double error = 0.0;       ///< of polynomials of degree c on it, estimated_interpolation_error()
};

/// The mesh equidistributes the error that polynomials of degree `collocation` would make. It has `intervals`
/// intervals, and more where the orbit is so sharp that the error would be larger than 1e-7.
OrbitSamples sample_orbit(const HybridSystem& system, const FoundOrbit& orbit, const Eigen::VectorXd& par,
                          int intervals, int collocation);

}  // namespace tchat

/// The smooth torus of fvdp (3.3), integrated without a wall.
#pragma once

#include <cmath>

#include "grazing_problems.hpp"
#include "motion/orbit_flow.hpp"

namespace tchat::test {

/// Section points of fvdp's smooth torus (3.3), x1 at its maxima (event function 2) or at a constant phase (3).
inline Eigen::MatrixXd torus_points(const Eigen::VectorXd& par, int event, int count) {
  const HybridSystem& system = system_of<ForcedVanDerPol>();
  FlowOptions options;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-13;
  options.variational = false;
  Eigen::VectorXd x = integrate_for(system, 1, Eigen::Vector3d(1.0, 0.0, 0.0), par, 400.0, options).end_state;
  Eigen::MatrixXd points(3, count);
  for (int k = 0; k < count; ++k) {
    x = integrate_segment(system, {1, event, 2}, x, par, options).end_state;
    x(2) = std::fmod(x(2), 6.283185307179586);
    points.col(k) = x;
  }
  return points;
}

}  // namespace tchat::test

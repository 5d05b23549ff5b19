/// Compares the derivatives of a problem's boundary conditions with differences, at random ends of segments.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

struct BoundaryCheck {
  int segments = 1;
  int conditions = 0;
  double error = 0.0;  ///< worst |supplied - difference| / scale
  std::vector<std::string>
      faults;  ///< the first few entries that differ by more than 1e-6 of the scale, or are not finite
};

/// `par`: PAR without durations, which are random.
BoundaryCheck check_boundary(const HybridSystem& system, int segments, const Eigen::VectorXd& par, unsigned seed);

/// A line of the report of `tchat check`.
std::string to_text(const BoundaryCheck& check);

}  // namespace tchat

/// Which events a smooth flow meets between two intersections with a section.
#pragma once

#include <Eigen/Core>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "motion/flow_options.hpp"

namespace tchat {

/// From z on the section (event function `section`, whether it ends segments or not) to its next fall: the index
/// vectors met on the way, then (field, section, 0). The first mode is what the problem says of a start, `field` where
/// it says nothing. Throws ComputationError when the flow does not come back, or after `most` segments.
Signature return_path(const HybridSystem& system, const Eigen::VectorXd& z, const Eigen::VectorXd& par, int section,
                      int field, const FlowOptions& options, int most = 1000);

}  // namespace tchat

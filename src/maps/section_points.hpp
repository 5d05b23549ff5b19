/// Points of a section from a file: O.events of a simulation, or O.sweep.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"

namespace tchat {

struct SectionPoints {
  int event = 0;           ///< the event function that fell through zero there
  int field = 1;           ///< of the flow that came in
  Eigen::MatrixXd states;  ///< before the jump, n x K, in the order of time
};

/// Those of each event function that there are points of, in the order of their numbers; of `event` alone where that is
/// not 0. Throws UserError with file, line and cure: no such file, not one of `system`, no point of that event.
std::vector<SectionPoints> read_section_points(const HybridSystem& system, const std::string& path, int event);

}  // namespace tchat

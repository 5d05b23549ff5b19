/// Where a simulation starts: parameter values, state, and the rule of its modes.
#pragma once

#include <string>
#include <vector>

#include "model/parameter_vector.hpp"
#include "motion/mode_rule.hpp"
#include "motion/surface_start.hpp"
#include "simulate/simulation_constants.hpp"
#include "simulate/simulation_request.hpp"

namespace tchat {

struct SimulationStart {
  ParameterVector par;
  Eigen::VectorXd state;
  std::string source;  ///< of the state, for people: "the problem's starting state"
  ModeRule rule;
  StartSide side;
  std::vector<IndexVector> watched = {};  ///< first, after the orbit's last event; empty: the rule says it
};

/// Index of a state, from 1, by the problem's name for it or U(k). Throws UserError that begins with `where` and lists
/// the names.
int state_index(const HybridSystem& system, const std::string& name, const std::string& where);

/// Parameters: plugin < .dat or label < command line. State: --state, -d (first row), -s (start of segment 1 of label
/// IRS), the problem's starting state, zeros. A label or a .dat starts after the last event of its orbit, in the mode
/// that follows there; any other state on the side of a surface that the request gives. Throws UserError.
SimulationStart simulation_start(const SimulationRequest& request, const SimulationConstants& constants,
                                 const HybridSystem& system);

}  // namespace tchat

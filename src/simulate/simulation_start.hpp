/// Where a simulation starts: parameter values, state, and the rule of its modes.
#pragma once

#include <string>

#include "hybrid/parameter_vector.hpp"
#include "simulate/simulation_constants.hpp"
#include "simulate/simulation_request.hpp"
#include "simulation/mode_rule.hpp"

namespace tchat {

struct SimulationStart {
  ParameterVector par;
  Eigen::VectorXd state;
  std::string source;  ///< of the state, for people: "the problem's starting state"
  ModeRule rule;
};

/// Parameters: plugin < .dat or label < command line. State: --state, -d (first row), -s (start of segment 1 of label
/// IRS), the problem's starting state, zeros. Throws UserError.
SimulationStart simulation_start(const SimulationRequest& request, const SimulationConstants& constants,
                                 const HybridSystem& system);

}  // namespace tchat

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

/// Index of a state, from 1, by the problem's name for it or U(k). Throws UserError that begins with `where` and lists
/// the names.
int state_index(const HybridSystem& system, const std::string& name, const std::string& where);

/// Parameters: plugin < .dat or label < command line. State: --state, -d (first row), -s (start of segment 1 of label
/// IRS), the problem's starting state, zeros. Throws UserError.
SimulationStart simulation_start(const SimulationRequest& request, const SimulationConstants& constants,
                                 const HybridSystem& system);

}  // namespace tchat

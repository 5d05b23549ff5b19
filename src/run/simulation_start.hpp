/// Where a simulation starts: constants if there are any, parameter values, state, and the rule of its modes.
#pragma once

#include <string>

#include "constants/run_settings.hpp"
#include "hybrid/parameter_vector.hpp"
#include "run/simulation_request.hpp"
#include "simulation/mode_rule.hpp"

namespace tchat {

struct SimulationSettingsFile {
  RunSettings settings;
  std::string path;  ///< empty: no constants file, all constants have their defaults
  bool is_given() const { return !path.empty(); }
};

struct SimulationStart {
  ParameterVector par;
  Eigen::VectorXd state;
  std::string source;  ///< of the state, for people: "the problem's starting state"
  ModeRule rule;
};

/// gc.C of -c, or gc.NAME if there is one, with the command line's constants. Throws UserError when it does not fit the
/// problem.
SimulationSettingsFile simulation_constants(const SimulationRequest& request, const HybridSystem& system);

/// Parameters: plugin < .dat or label < command line. State: --state, -d (first row), -s (start of segment 1 of label
/// IRS), the problem's starting state, zeros. Mode: --mode, what the index jump function says of a start, the first
/// index vector of the signature. Throws UserError.
SimulationStart simulation_start(const SimulationRequest& request, const SimulationSettingsFile& constants,
                                 const HybridSystem& system);

}  // namespace tchat

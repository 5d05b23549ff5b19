/// What every command that simulates begins with: the plugin loaded, the constants read and brought together with it.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "motion/hybrid_simulation.hpp"
#include "plugin/problem_library.hpp"
#include "simulate/simulation_constants.hpp"
#include "simulate/simulation_request.hpp"

namespace tchat {

struct LoadedProblem {
  std::string plugin;  ///< path of the shared library
  SimulationConstants constants;
  std::unique_ptr<ProblemLibrary> library;
};

/// Compiles the plugin where that is needed; `progress`, if given, is told about it. Throws UserError.
LoadedProblem load_for_simulation(const SimulationRequest& request, std::ostream* progress);

/// The integrator's method and tolerances, and what is noted, as the command line says.
SimulationSettings simulation_settings(const SimulationRequest& request, const std::function<bool()>& interrupted);

}  // namespace tchat

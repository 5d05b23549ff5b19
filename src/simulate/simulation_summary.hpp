/// A simulation told to people: where it started, what happened, what it settled on.
#pragma once

#include <string>

#include "simulate/simulation_start.hpp"
#include "simulation/found_orbit.hpp"
#include "simulation/simulation_run.hpp"

namespace tchat {

/// "linosc with alpha = 3, omega = 2"
std::string problem_text(const HybridSystem& system, const Eigen::VectorXd& par);

/// Parameters, start and first mode.
std::string start_text(const HybridSystem& system, const SimulationStart& start, const Mode& mode);

/// How long it ran, why it ended, what was seen on the way.
std::string course_text(const HybridSystem& system, const SimulationResult& result, double end_time, double contact);

/// The periodic orbit: signature, segments, multipliers, stability.
std::string orbit_text(const HybridSystem& system, const FoundOrbit& orbit);

/// Why no orbit was recognised and what may help.
std::string no_orbit_text(const SimulationResult& result, const SimulationPlan& plan);

}  // namespace tchat

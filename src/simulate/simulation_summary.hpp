/// A simulation told to people: where it started, what happened, what it settled on.
#pragma once

#include <string>

#include "motion/attractor_search.hpp"
#include "motion/found_orbit.hpp"
#include "motion/simulation_run.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

/// "linosc with alpha = 3, omega = 2"
std::string problem_text(const HybridSystem& system, const Eigen::VectorXd& par);

/// Parameters, start and first mode.
std::string start_text(const HybridSystem& system, const SimulationStart& start, const Mode& mode);

/// How long it ran, why it ended, what was seen on the way.
std::string course_text(const HybridSystem& system, const SimulationResult& result, double end_time, double contact);

/// That the motion comes to rest at this equilibrium of a field.
std::string rest_text(const Eigen::VectorXd& equilibrium);

/// The periodic orbit: signature, segments, multipliers, stability.
std::string orbit_text(const HybridSystem& system, const FoundOrbit& orbit);
/// "stable", or what else the multipliers say.
std::string stability_text(OrbitStability stability, double uncertainty);

/// What Newton's method has made of so many recorded events (--refine) of a motion whose states have this size, and of
/// those of a motion that repeats itself where it has not converged.
std::string refined_text(const FoundOrbit& orbit, long events, const Eigen::VectorXd& size);
std::string not_refined_text(const FoundOrbit& orbit, long events);
/// Why there is no period to refine.
std::string nothing_recorded_text(const SimulationPlan& plan);

/// Why `search` recognised no orbit and what may help.
std::string no_orbit_text(const SimulationResult& result, const SimulationPlan& plan, const AttractorSearch& search);

}  // namespace tchat

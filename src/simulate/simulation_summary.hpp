/// Messages of a simulation: notices on its start, and the summary at its end.
#pragma once

#include <string>
#include <vector>

#include "motion/attractor_search.hpp"
#include "motion/found_orbit.hpp"
#include "motion/hybrid_simulation.hpp"
#include "motion/settle.hpp"
#include "simulate/simulation_start.hpp"

namespace tchat {

// What a user should know of a start before the simulation runs. The one owner of that check: `tchat simulate` prints
// each notice, `tchat sweep` counts them.

struct StartNotice {
  enum class Kind {
    behind,         ///< h_j < 0: nothing happens until h_j has risen above zero
    field_changes,  ///< on the surface of an event after which another field holds, and falling
    after_event,    ///< on a surface and falling: taken as a state after the event
    before_event,   ///< likewise: the event happens at once
    released,       ///< in contact, behind its release: goes on as after it
  } kind = Kind::behind;
  int event = 0;
  double h = 0.0;
  auto operator<=>(const StartNotice&) const = default;
};

/// Of the events of the first mode, before the first segment. Sections, after which all goes on as before, take both
/// signs. Usually empty.
std::vector<StartNotice> start_notices(const HybridSimulation& simulation);

/// A paragraph each, with what the user can do.
std::string notice_text(const HybridSystem& system, const StartNotice& notice);

/// Of several starts: how many of `starts` have each notice, and the event. "" when none has one.
std::string notice_summary(const HybridSystem& system, const std::vector<StartNotice>& notices, std::size_t starts);

/// Why --after-event or --before-event changes nothing; "" when it does, or was not given.
std::string side_without_effect(const HybridSimulation& simulation, const StartSide& side);

/// "event 1 (wall)"
std::string event_name(const HybridSystem& system, int event);

// A simulation told to people: where it started, what happened, what it settled on.

/// "linosc with alpha = 3, omega = 2"
std::string problem_text(const HybridSystem& system, const Eigen::VectorXd& par);

/// Parameters, start and first mode.
std::string start_text(const HybridSystem& system, const SimulationStart& start, const Mode& mode);

/// How long it ran, why it ended, what was seen on the way.
std::string course_text(const HybridSystem& system, const SimulationResult& result, const Eigen::VectorXd& par,
                        double contact);

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
std::string no_orbit_text(const HybridSystem& system, const SimulationResult& result, const SimulationPlan& plan,
                          const AttractorSearch& search);

}  // namespace tchat

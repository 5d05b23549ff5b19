/// Events that may come next by the problem's successors, but that no segment of the run watches or ends at.
#pragma once

#include <string>

#include "bvp/orbit.hpp"
#include "constants/run_settings.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

/// What a user has to know of them, with the cure: an orbit that such an event would end goes on through it, and
/// nothing else tells. Not of those that are negative on their segment. "" when there is none, or the problem has no
/// successors. A start in which a segment follows another than the successors allow says nothing of that segment.
/// Starts of tori hold many returns of the signature, each of which counts.
std::string unwatched_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start);

/// Adds those events to the monitored ones of their segments (GCHGRZIND).
void watch_possible_events(const HybridSystem& system, RunSettings& settings, const Orbit& start);

}  // namespace tchat

/// Events that may come next by the problem's successors, but that no segment of the run watches or ends at.
#pragma once

#include <string>

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

/// A warning with the cure, for no other message reports an orbit that continues through such an event. Events that are
/// negative on their segment are left out, and segments that follow others than the successors allow. "" when there is
/// no such event, or the problem has no successors. Starts of tori hold many returns of the signature, and each counts.
std::string unwatched_events(const HybridSystem& system, const RunSettings& settings, const Orbit& start);

/// Adds those events to the monitored ones of their segments (GCHGRZIND).
void watch_possible_events(const HybridSystem& system, RunSettings& settings, const Orbit& start);

}  // namespace tchat

/// What a user should know of a start before the simulation runs. The one owner of that check: `tchat simulate` prints
/// each notice, `tchat sweep` counts them.
#pragma once

#include <string>
#include <vector>

#include "motion/hybrid_simulation.hpp"

namespace tchat {

struct StartNotice {
  enum class Kind {
    behind,         ///< h_j < 0: nothing happens until h_j has risen above zero
    field_changes,  ///< on the surface of an event after which another field holds, and falling
    after_event,    ///< on a surface and falling: taken as a state after the event
    before_event,   ///< likewise: the event happens at once
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

}  // namespace tchat

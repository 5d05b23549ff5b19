#include "kinds/double_event.hpp"

#include <fmt/format.h>

#include "base/user_error.hpp"
#include "orbit/curve_conditions.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "run/orbit_start.hpp"

namespace tchat {

namespace {

[[noreturn]] void refuse(const SelectedStart& start, const std::string& why) {
  throw UserError(fmt::format("{}: no curve with ISW = 2 begins at label {} (GR): {}", start.source, start.label, why));
}

}  // namespace

/// Where the second event function vanishes. A segment that lasts no time has the same state at both ends: at its start
/// its own event function is not among the conditions.
std::unique_ptr<OrbitCondition> double_event_condition(const DefiningSystem& defining, const SelectedStart& start) {
  const UserPointKind& kind = start.kind;
  const Orbit& x = start.start.orbit;
  const int s = kind.segment - 1;
  if (kind.kind == UserPointKind::impact_velocity)
    refuse(start, fmt::format("the orbit is tangent to the surface of event {} at the end of segment {}; tchat "
                              "resegment --to grazing-curve makes the start of the curve of such orbits",
                              kind.index, kind.segment));
  if (kind.kind != UserPointKind::contact || s < 0 || s >= defining.segments())
    refuse(start, "the label is no place where two events come at once");
  const bool whole = lasts_no_time(x, s);
  if (!whole && kind.tau > 0.0 && kind.tau < 1.0)
    refuse(start, fmt::format("the contact is inside segment {}, where the orbit touches a surface; tchat resegment "
                              "--to grazing-curve makes the start of the curve of such orbits",
                              kind.segment));
  const bool at_end = !whole && kind.tau == 1.0;
  const bool ended_by = at_end && defining.signature()[static_cast<std::size_t>(s)].event == kind.index;
  if (ended_by || (!at_end && is_pinned_start(defining.system(), defining.signature(), x, s, kind.index)))
    refuse(start, fmt::format("event {} vanishes at the {} of segment {} for every orbit of this signature", kind.index,
                              at_end ? "end" : "start", kind.segment));
  return std::make_unique<EventCondition>(defining, x.shape, s, kind.index, at_end);
}

}  // namespace tchat

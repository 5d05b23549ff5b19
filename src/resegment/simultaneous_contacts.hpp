/// All places where an orbit is in grazing contact at its label: a symmetric one touches at several at once.
#pragma once

#include <optional>
#include <vector>

#include "resegment/contact_point.hpp"

namespace tchat {

/// `own`, which the label names, and every further contact of a monitored event function (GCHGRZIND) inside a segment
/// or on a Poincare section; where `own` is an impact of velocity zero, further ones of these. In their order along the
/// orbit; the label's tolerance decides what is a contact.
std::vector<ContactPoint> simultaneous_contacts(const ContactPoint& own, const Orbit& x, const HybridSystem& system,
                                                const RunSettings& settings);

/// An event function other than `event` that falls through zero where segment s (from 0) ends: a Poincare section on
/// which an orbit can be cut there whether it touches or not. Nothing when the problem has none.
std::optional<int> section_at_end(const Orbit& x, const HybridSystem& system, int s, int field, int event);

}  // namespace tchat

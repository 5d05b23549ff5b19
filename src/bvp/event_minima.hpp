/// Where an event function is least along a segment.
///
/// Minima are looked for on the collocation polynomial, between a node where h falls and the next one where it rises:
/// a dip that is narrower than the distance of nodes and leaves the slopes of h there unchanged is not seen. They are
/// polished: the flow is integrated from the mesh point on their left, so that h has the accuracy of mesh points (order
/// 2 NCOL), not that of the polynomial in between.
///
/// A pinned end is no candidate, since the boundary conditions themselves hold h at zero there: the segment's own
/// terminal event at its end, and a start on the surface just left. Nor is a minimum that a pinned end with the wrong
/// slope brings with it, which is the impact velocity's business.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "bvp/collocation_rule.hpp"
#include "bvp/defining_system.hpp"
#include "bvp/orbit.hpp"
#include "hybrid/hybrid_system.hpp"

namespace tchat {

struct EventMinimum {
  double tau = 0.0;
  double value = 0.0;     ///< h
  Eigen::VectorXd state;  ///< n
};

/// Is the start of segment s (from 0) pinned for an event function: does the jump before it land on the surface h = 0
/// by structure (h = 0 there, gradient of h o g parallel to that of the previous terminal event)?
bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event);

/// An event function along a segment.
struct EventCourse {
  Eigen::VectorXd at_nodes;          ///< h at every node
  std::vector<EventMinimum> minima;  ///< inside the segment, in order
};

/// Of event function `event` along segment s (from 0), with the minima where h is less than `below` on the polynomial;
/// none where the segment lasts no positive time.
EventCourse event_course(const HybridSystem& system, const Signature& signature, const CollocationRule& rule,
                         const Orbit& x, int s, int event, double below = std::numeric_limits<double>::infinity());

/// The ends that are not pinned, then the interior minima in order.
std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           int s, int event);

/// The candidate with the least value; nothing without candidates.
std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        int s, int event);

}  // namespace tchat

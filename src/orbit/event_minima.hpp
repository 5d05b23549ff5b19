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

#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

struct EventMinimum {
  double tau = 0.0;
  double value = 0.0;     ///< h
  Eigen::VectorXd state;  ///< n
};

/// Is the start of segment s (from 0) pinned for an event function: does the jump before it land on the surface h = 0
/// by structure (h = 0 there, gradient of h o g parallel to that of the previous terminal event)?
bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event);
/// The same where the scale of the event function (orbit.hpp) is known.
bool is_pinned_start(const HybridSystem& system, const Signature& signature, const Orbit& x, int s, int event,
                     double scale);

/// A place where h turns from falling to rising: at sigma in [0, 1] of a mesh interval.
struct EventDip {
  int interval = 0;
  double sigma = 0.0;
  double value = 0.0;  ///< h on the polynomial
};

/// Event function `event` along segment s (from 0).
struct EventCourse {
  int segment = 0;
  int event = 0;
  Eigen::VectorXd at_nodes;           ///< h at every node
  std::vector<EventDip> dips;         ///< inside the segment, in order; none where it lasts no positive time
  bool first_hangs_on_start = false;  ///< h rises nowhere before the first dip
  bool last_hangs_on_end = false;     ///< h falls nowhere after the last one
  /// event_scale() of the orbit (orbit.hpp), which takes a look at all segments; nothing where nobody has.
  std::optional<double> scale = {};
};

/// course.scale, or what it would be.
double scale_of(const HybridSystem& system, const Orbit& x, const EventCourse& course);

/// Scales of the event functions of one orbit, each computed once.
class EventScales {
 public:
  /// For another orbit. Allocates at the first call at most.
  void begin(const HybridSystem& system);
  double of(const HybridSystem& system, const Orbit& x, int event);

 private:
  std::vector<std::optional<double>> known_;
};

/// Finds the courses along orbits of one shape. After the first orbit nothing is allocated except for dips.
class EventCourseFinder {
 public:
  /// Segment `course.segment` has the field `field`.
  void find(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x, EventCourse& course);

 private:
  void find_gradients(const HybridSystem& system, const Orbit& x, EventCourse& course);
  void find_slopes(const CollocationRule& rule, const Orbit& x, int s);
  void find_dips(const HybridSystem& system, int field, const CollocationRule& rule, const Orbit& x,
                 EventCourse& course) const;

  Eigen::MatrixXd gradients_;  // of h at the nodes, one a column
  Eigen::MatrixXd rates_;      // d u / d tau times the interval's length at the nodes of each interval
  Eigen::MatrixXd slopes_;     // d h / d tau at the nodes of each interval, which is a column
};

/// Of every event function monitored on a segment, one segment after the other.
std::vector<EventCourse> event_courses(const HybridSystem& system, const Signature& signature,
                                       const std::vector<std::vector<int>>& monitored, const CollocationRule& rule,
                                       const Orbit& x);

/// The dips of a course where h is less than `below` on the polynomial, polished.
std::vector<EventMinimum> polished_minima(const HybridSystem& system, const Signature& signature,
                                          const CollocationRule& rule, const Orbit& x, const EventCourse& course,
                                          double below = std::numeric_limits<double>::infinity());

/// The ends that are not pinned, then the interior minima in order.
std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           const EventCourse& course);
std::vector<EventMinimum> least_candidates(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                           int s, int event);

/// The candidate with the least value; nothing without candidates.
std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        const EventCourse& course);
std::optional<EventMinimum> least_value(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                                        int s, int event);
/// Its value alone: no allocation where there is no dip.
std::optional<double> least_h(const DefiningSystem& system, const CollocationRule& rule, const Orbit& x,
                              const EventCourse& course);

}  // namespace tchat

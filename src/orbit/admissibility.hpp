/// Is a solution of the boundary value problem an orbit of the model? (Fig. 5.10)
///
/// Checked with the accuracy of orbits (orbit_accuracy.hpp), of the period, of the size of h and of |h_x| |f|: T_s >=
/// 0; h >= 0 at the stored points of every event function monitored on a segment; h_x f <= 0 at every terminal point;
/// and what sliding asks for at the starts of segments (sliding_violations.hpp).
/// Between stored points h is looked at where it has a minimum (event_minima.hpp); it counts there beyond 1e-6 of its
/// size and twice what the error of the states makes of it. Pinned ends are left out.
#pragma once

#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"
#include "orbit/transversality.hpp"

namespace tchat {

struct Violation {
  enum Kind {
    negative_duration,
    event_crossed,
    leaving_terminal_surface,
    off_surface,             ///< a segment slides beside its surface
    side_leads_away,         ///< a segment slides where one of the two fields leads away from the surface
    crosses_where_it_slides  ///< a surface is crossed where both fields point at it
  };
  Kind kind;
  int segment = 1;     ///< from 1
  int event = 0;       ///< of an event function; of the last two kinds the field
  double tau = 0.0;    ///< where it is worst
  double value = 0.0;  ///< T_s, h, or h_x f; of the last two kinds h_x f in the direction that it must not have
};

/// `monitored[s]` lists the event functions monitored on segment s, whose courses are `courses` (event_courses).
/// `error` is the estimated relative error of the
/// states between mesh points (discretisation_error.hpp). A segment leaves its terminal surface when h_x f is more than
/// `leaving` of |h_x| |f|: at a located special point, where two segments may meet their surfaces tangentially at once,
/// that is known to the accuracy of the location.
std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x,
                                         const std::vector<EventCourse>& courses, const CollocationRule& rule,
                                         double error, double leaving = no_transversality);
std::vector<Violation> inadmissibilities(const HybridSystem& system, const Signature& signature,
                                         const std::vector<std::vector<int>>& monitored, const Orbit& x,
                                         const CollocationRule& rule, double error, double leaving = no_transversality);

/// "segment 1: h1 (wall) = -0.02 at tau = 0.31"
std::string describe(const Violation& violation, const HybridSystem& system);

}  // namespace tchat

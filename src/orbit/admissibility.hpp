/// Which solutions are orbits of the model: event functions keep their signs inside segments, ends are transversal, and
/// sliding starts where it may.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "base/levels.hpp"
#include "model/hybrid_system.hpp"
#include "orbit/collocation_rule.hpp"
#include "orbit/defining_system.hpp"
#include "orbit/event_minima.hpp"
#include "orbit/orbit.hpp"

namespace tchat {

// How an orbit meets the section that ends a segment: h_x f there, negative where the event function falls through
// zero.

/// |h_x f| / (|h_x| |f|) up to this is zero: grazing, or a section that the orbit touches. The sign of less says
/// nothing, nor does what has been divided by it.
inline constexpr double no_transversality = orbit_accuracy;
/// At a contact that was located as a zero of h, which is quadratic there, h_x f is known to the root of that (EPSS):
/// up to this share of |h_x| |f| the contact is tangent, more is a crossing.
inline constexpr double tangent_contact = level::same;

struct Crossing {
  double rate = 0.0;   ///< h_x f, the velocity of an impact when h is a distance
  double sizes = 0.0;  ///< |h_x| |f|

  /// h_x f / (|h_x| |f|), from -1 to 1; 0 when h_x or f vanishes.
  double transversality() const { return sizes > 0.0 ? rate / sizes : 0.0; }
  bool touches() const { return !(std::abs(transversality()) > no_transversality); }
};

/// At the end of segment s (from 0), with the gradient of the section there. Where no event ends it, nothing is
/// touched: the flow crosses at a right angle.
Crossing crossing_at_end(const DefiningSystem& system, const Orbit& x, int s);
/// Of an event's own surface.
Crossing crossing_of_event(const HybridSystem& system, int event, int field, const double* x, const double* par);

// Is a solution of the boundary value problem an orbit of the model? (Fig. 5.10)
//
// Checked with the accuracy of orbits (orbit.hpp), of the period, of the size of h and of |h_x| |f|: T_s >=
// 0; h >= 0 at the stored points of every event function monitored on a segment; h_x f <= 0 at every terminal point;
// and what sliding asks for at the starts of segments (add_sliding_violations()).
// Between stored points h is looked at where it has a minimum (event_minima.hpp); it counts there beyond 1e-6 of its
// size and twice what the error of the states makes of it. Pinned ends are left out.

struct Violation {
  enum Kind {
    negative_duration,
    event_crossed,
    leaving_terminal_surface,
    off_surface,              ///< a segment slides beside its surface
    side_leads_away,          ///< a segment slides where one of the two fields leads away from the surface
    crosses_where_it_slides,  ///< a surface is crossed where both fields point at it
    against_rules             ///< the problem says what follows, and it is another index vector
  };
  Kind kind;
  int segment = 1;     ///< from 1
  int event = 0;       ///< of an event function; of the last two kinds the field
  double tau = 0.0;    ///< where it is worst
  double value = 0.0;  ///< T_s, h, or h_x f; of the last two kinds h_x f in the direction that it must not have
};

/// `monitored[s]` lists the event functions monitored on segment s, whose courses are `courses` (event_courses).
/// `error` is the estimated relative error of the
/// states between mesh points (collocation_rule.hpp). A segment leaves its terminal surface when h_x f is more than
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

// What the problem says that follows an event (its index jump function, lines `after EVENT if CONDITION` of formulas).

/// May segment s + 1 follow segment s (from 0)? Not where the rules, at the state at its end and at all states beside
/// it that are the same up to the accuracy of a located point, have another jump for its event in its field. All else
/// is the user's choice: other fields, events that cut the orbit, segments of no duration, contacts.
bool follows_rules(const HybridSystem& system, const Signature& signature, const Orbit& x, int s);
/// The same of the state at its end alone.
bool follows_rules_there(const HybridSystem& system, const Signature& signature, const Orbit& x, int s);
/// Do the impacts before a limit cease to accumulate here? The limit has no derivative then.
bool is_at_border_of_chatter(const HybridSystem& system, const Signature& signature, const Orbit& x);

// What a segment that slides, or one that crosses a surface on which orbits may slide, must do at its start.

/// Violations at the start of segment s (from 0): it slides off the surface, or where a side's field leads away (unless
/// the event function that says so is among `monitored`, which is looked at elsewhere); or it goes on to the other side
/// where that side's field leads back, so that the orbit slides. `leaving`: as in inadmissibilities().
void add_sliding_violations(std::vector<Violation>& violations, const HybridSystem& system, const Signature& signature,
                            const std::vector<int>& monitored, const Orbit& x, int s, double leaving);

}  // namespace tchat

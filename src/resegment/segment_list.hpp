/// The segments of a new orbit and the constants of its run.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/hybrid_system.hpp"
#include "resegment/contact_point.hpp"
#include "resegment/orbit_pieces.hpp"
#include "settings/problem_type.hpp"
#include "settings/run_settings.hpp"

namespace tchat {

// The segments of a new orbit while they are put together: which piece of the old orbit, which index vector, which
// event functions to monitor.

struct WatchedEvent {
  int event = 1;
  bool located = true;  ///< a test function of the run (GCIPSI), not only checked for admissibility
};

struct NewSegment {
  OrbitPiece piece;
  IndexVector index;
  bool grazes = false;  ///< ends in grazing contact (IPS = 150)
  std::vector<WatchedEvent> watched;
};

using SegmentList = std::vector<NewSegment>;

/// The old orbit's own segments, whole.
SegmentList segments_of(const RunSettings& settings);

/// Segments K+1, K+2, ..., 1, ..., K; K any integer.
SegmentList rotated(const SegmentList& segments, int k);

/// All segments once more. Throws UserError beyond the largest number of segments.
SegmentList repeated(const SegmentList& segments);

/// Further segments at the end. Throws UserError beyond the largest number of segments.
SegmentList joined(SegmentList segments, const SegmentList& further);

/// Adds an event function to those that a segment monitors, unless it is there.
void watch(NewSegment& segment, int event);

/// The signature cut at contacts, and the positions (from 0, rising) of the segments that now end there.
struct CutList {
  SegmentList segments;
  std::vector<std::size_t> contacts;
};

/// Segment contact.segment now ends in the contact's event with jump `jump`; the rest of a segment cut inside follows
/// with its own event and jump. A section that the contact lies on is replaced. Several contacts are cut from the last
/// one on the orbit to the first.
CutList cut_at(CutList cut, const ContactPoint& contact, int jump);

/// Without the segments of no duration (of orbit x) that follow contact k: those of an impact of velocity zero.
CutList without_empty_segments(CutList cut, std::size_t k, const Orbit& x);

/// With `count` segments of zero duration after contact k, constant there; index vectors are still to be set.
CutList with_empty_segments(CutList cut, std::size_t k, int count);

// The constants of a run that starts from a resegmented orbit: those of the run that found the label, with what the
// new signature changes.

struct NewProblem {
  int problem_type = periodic_orbit.number;      ///< IPS
  int branch_mode = periodic_orbit.branch_mode;  ///< ISW
  int grazing_jump = 1;                          ///< GRJUMP
  bool names_parameters = false;                 ///< the user gives ICP, so what is missing there is no fault
};

/// Free parameters: the problem's own in their order (a second one is added where the problem type needs it, and left
/// out where it does not), then all durations. Weights of durations go with the pieces; user values of durations and
/// rules to stop are dropped. Test functions: xi_1..xi_5 on a grazing curve, otherwise the located ones of the watched
/// events. Throws UserError when no second parameter of the problem is known.
RunSettings new_settings(const RunSettings& old, const SegmentList& segments, const NewProblem& problem,
                         const HybridSystem& system);

}  // namespace tchat

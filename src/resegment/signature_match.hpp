/// Segments of zero duration: which ones follow an impact, and orbits of one signature as orbits of another.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/hybrid_system.hpp"
#include "model/index_vector.hpp"
#include "orbit/orbit.hpp"
#include "resegment/segment_list.hpp"

namespace tchat {

// Which segments of zero duration follow an impact that is born at grazing, and whether a signature fits an orbit.

/// The index vectors between the impact `after` in state x and a segment with field `next_field`, by the index jump
/// function: none when that field may follow directly or the plugin has no index jump function; otherwise the one
/// index vector that may follow, whose event holds in the state after the impact, and which `next_field` may follow.
/// Throws UserError when there is no such index vector or more than one: the signature has to be given.
Signature segments_after_impact(const HybridSystem& system, const IndexVector& after, const Eigen::VectorXd& x,
                                const ParameterVector& par, int next_field);

/// The event functions to watch on a segment of index vector `own` that follows `before`, which ended (before its jump)
/// in state x: those of the index jump function's index vectors, without Poincare sections (identity jump, the same
/// field after it; of `own` the next segment's field tells). x may lie where the function changes its mind: it is asked
/// beside x as well, at a share of the `sizes` of states. Empty when the plugin has none or it leads to other fields.
std::vector<int> watched_after(const HybridSystem& system, const IndexVector& before, const Eigen::VectorXd& x,
                               const ParameterVector& par, const Eigen::VectorXd& sizes, const IndexVector& own,
                               int next_field);

/// Throws UserError that names the segment when a terminal event does not hold at a segment's end or a jump does not
/// lead to the next segment's start, coarsely: what Newton is meant to repair passes.
void require_fit(const HybridSystem& system, const Signature& signature, const Orbit& x);

// An orbit at which segments last no time, as an orbit of another signature: where two events come at once, they may
// change places, a segment may vanish or a new one appear.

/// The segments of `old` (whole, of orbit x) that last some time become, in their cyclic order, segments of `signature`
/// with the same fields; the other index vectors of `signature` become segments of zero duration, in the state that the
/// jumps before them lead to. Of all ways to do so the one whose terminal events and jumps fit best is taken, of equal
/// ones that with the least rotation. Segments that last keep what they watch; of an old grazing segment the one that
/// takes its place, if it ends in the same event, grazes. Throws UserError when the numbers of segments do not allow it
/// or when nothing fits (then it says what fits worst).
SegmentList matched(const HybridSystem& system, const SegmentList& old, const Orbit& x, const Signature& signature);

// An orbit with chatter (tchat_chatter) on which more impacts, or fewer, come before the limit of all others.

struct OtherImpacts {
  Orbit orbit;
  SegmentList segments;  ///< of `orbit`, whole
};

/// The segments of `old` (whole, of orbit x) as `signature` has them, if the two differ in how many impacts come before
/// limits, and nothing where they differ otherwise or not at all. Further flights are integrated, and so is the contact
/// after such a limit, which begins where the impacts that the limit stands for do. Throws UserError where there are no
/// so many impacts before the release.
std::optional<OtherImpacts> with_other_impacts(const HybridSystem& system, const SegmentList& old, const Orbit& x,
                                               const Signature& signature);

}  // namespace tchat

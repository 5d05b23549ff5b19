/// An orbit at which segments last no time, as an orbit of another signature: where two events come at once, they may
/// change places, a segment may vanish or a new one appear.
#pragma once

#include "model/hybrid_system.hpp"
#include "orbit/orbit.hpp"
#include "resegment/segment_list.hpp"

namespace tchat {

/// The segments of `old` (whole, of orbit x) that last some time become, in their cyclic order, segments of `signature`
/// with the same fields; the other index vectors of `signature` become segments of zero duration, in the state that the
/// jumps before them lead to. Of all ways to do so the one whose terminal events and jumps fit best is taken, of equal
/// ones that with the least rotation. Segments that last keep what they watch; of an old grazing segment the one that
/// takes its place, if it ends in the same event, grazes. Throws UserError when the numbers of segments do not allow it
/// or when nothing fits (then it says what fits worst).
SegmentList matched(const HybridSystem& system, const SegmentList& old, const Orbit& x, const Signature& signature);

}  // namespace tchat

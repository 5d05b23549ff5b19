/// What a segment that slides, or one that crosses a surface on which orbits may slide, must do at its start.
#pragma once

#include <vector>

#include "orbit/admissibility.hpp"

namespace tchat {

/// Violations at the start of segment s (from 0): it slides off the surface, or where a side's field leads away (unless
/// the event function that says so is among `monitored`, which is looked at elsewhere); or it goes on to the other side
/// where that side's field leads back, so that the orbit slides. `leaving`: as in inadmissibilities().
void add_sliding_violations(std::vector<Violation>& violations, const HybridSystem& system, const Signature& signature,
                            const std::vector<int>& monitored, const Orbit& x, int s, double leaving);

}  // namespace tchat

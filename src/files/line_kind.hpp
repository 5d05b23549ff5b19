/// Stability and admissibility of an orbit, or of a piece of a branch, as pictures show them.
#pragma once

namespace tchat {

enum class LineKind { stable, unstable, inadmissible };

}  // namespace tchat

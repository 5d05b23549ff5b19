/// The circle, in turns and in radians.
#pragma once

#include <cmath>

namespace tchat {

inline constexpr double full_turn = 6.283185307179586476925;

/// Of a phase in turns: in [0, 1).
inline double phase_fraction(double turns) { return turns - std::floor(turns); }
/// In [-1/2, 1/2).
inline double nearest_phase(double turns) { return turns - std::floor(turns + 0.5); }

}  // namespace tchat
